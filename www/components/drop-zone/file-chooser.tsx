// A file input that looks like a button and stays one for keyboard and screen reader.
import { Icon } from '../icon/icon.tsx';

interface FileChooserProps {
  readonly id: string;
  readonly label: string;
  readonly primary?: boolean;
  onFiles(files: FileList): void;
}

export function FileChooser({ id, label, primary = false, onFiles }: FileChooserProps) {
  return (
    <span class="file-chooser">
      <input
        id={id}
        type="file"
        multiple
        onChange={(event) => {
          const { files } = event.currentTarget;
          if (files !== null && files.length > 0) onFiles(files);
          // The same file may be chosen again.
          event.currentTarget.value = '';
        }}
      />
      <label for={id} class={primary ? 'button primary' : 'button quiet'} title={primary ? undefined : label}>
        <Icon name="open" />
        <span>{label}</span>
      </label>
    </span>
  );
}
