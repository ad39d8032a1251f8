// What is typed over a value: it counts at Enter or when the field is left, and Escape gives it up.
import { useState } from 'preact/hooks';

interface DraftProps {
  /** The draft, or the value while nothing is typed. */
  readonly value: string;
  onFocus(event: { readonly currentTarget: HTMLInputElement }): void;
  onInput(event: { readonly currentTarget: HTMLInputElement }): void;
  onBlur(): void;
  onKeyDown(event: KeyboardEvent): void;
}

/** For a field that shows `value`; `commit` is called with what was typed, if anything was. */
export function useDraft(value: string, commit: (typed: string) => void): DraftProps {
  const [draft, setDraft] = useState<string | null>(null);
  const end = (): void => {
    if (draft === null) return;
    setDraft(null);
    commit(draft);
  };
  return {
    value: draft ?? value,
    onFocus: ({ currentTarget }) => currentTarget.select(),
    onInput: ({ currentTarget }) => setDraft(currentTarget.value),
    onBlur: end,
    onKeyDown: (event) => {
      if (event.key === 'Enter') end();
      if (event.key === 'Escape' && draft !== null) {
        event.stopPropagation();
        setDraft(null);
      }
    },
  };
}
