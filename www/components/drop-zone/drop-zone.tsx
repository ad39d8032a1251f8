// The landing: where a model goes in. While a file hangs over the window it covers everything, model or not.
import type { ComponentChildren } from 'preact';
import { t } from '../../messages/messages.ts';
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
        <h1>{t('start.title')}</h1>
        <p>{t('start.drop')}</p>
        <div class="landing-choosers">
          <FileChooser id="landing-file" label={t('start.choose')} primary onFiles={onFiles} />
          <FileChooser id="landing-folder" label={t('start.folder')} folder onFiles={onFiles} />
        </div>
        <p class="landing-formats">{t('start.formats')}<br />{t('start.private')}</p>
      </div>
      <section aria-labelledby="samples-title">
        <h2 id="samples-title">{t('start.samples')}</h2>
        {children}
      </section>
    </main>
  );
}

/** Says where to let go. Shown by the application while something is dragged over the window. */
export function DropHint() {
  return (
    <div class="drop-hint" aria-hidden="true">
      <p>{t('start.letGo')}</p>
    </div>
  );
}
