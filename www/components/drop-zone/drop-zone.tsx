// The landing: where a model goes in. While a file hangs over the window it covers everything, model or not.
import type { ComponentChildren } from 'preact';
import { Logo } from '../logo/logo.tsx';
import { FileChooser } from './file-chooser.tsx';
import { MeshField } from './mesh-field.tsx';
import './drop-zone.css';

interface LandingProps {
  onFiles(files: FileList): void;
  /** The samples. */
  readonly children: ComponentChildren;
}

export function Landing({ onFiles, children }: LandingProps) {
  return (
    <main class="landing">
      <MeshField />
      <div class="landing-zone">
        <Logo size={56} />
        <h1>Fewer triangles, same&nbsp;look</h1>
        <p>Drop a 3D model anywhere on this page, or</p>
        <FileChooser id="landing-file" label="Choose a model" primary onFiles={onFiles} />
        <p class="landing-formats">GLB, OBJ, PLY, STL, OFF, SMF, or glTF with its files; also as a folder or ZIP.<br />Nothing leaves your device.</p>
      </div>
      <section aria-labelledby="samples-title">
        <h2 id="samples-title">or try one of these</h2>
        {children}
      </section>
    </main>
  );
}

/** Says where to let go. Shown by the application while something is dragged over the window. */
export function DropHint() {
  return (
    <div class="drop-hint" aria-hidden="true">
      <p>Drop it here</p>
    </div>
  );
}
