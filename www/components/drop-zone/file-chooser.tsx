// A file input that looks like a button and stays one for keyboard and screen reader; for files or for a folder.
import { Icon } from '../icon/icon.tsx';

interface FileChooserProps {
  readonly id: string;
  readonly label: string;
  readonly primary?: boolean;
  /** A whole folder is chosen, with all that is in it. */
  readonly folder?: boolean;
  /** The label is for screen readers alone. */
  readonly iconOnly?: boolean;
  onFiles(files: FileList): void;
}

/** Some browsers of phones have files only. */
const CHOOSES_FOLDERS = 'webkitdirectory' in HTMLInputElement.prototype;

export function FileChooser({ id, label, primary = false, folder = false, iconOnly = false, onFiles }: FileChooserProps) {
  if (folder && !CHOOSES_FOLDERS) return null;
  return (
    <span class={folder ? 'file-chooser folder-chooser' : 'file-chooser'}>
      <input
        id={id}
        type="file"
        multiple
        {...(folder ? { webkitdirectory: true } : {})}
        onChange={(event) => {
          const { files } = event.currentTarget;
          if (files !== null && files.length > 0) onFiles(files);
          // The same file may be chosen again.
          event.currentTarget.value = '';
        }}
      />
      <label for={id} class={primary ? 'button primary' : 'button quiet'} title={primary ? undefined : label}>
        <Icon name={folder ? 'folder' : 'open'} />
        <span class={iconOnly ? 'visually-hidden' : undefined}>{label}</span>
      </label>
    </span>
  );
}
