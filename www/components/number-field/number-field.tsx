// A number to be typed, with its unit: it counts at Enter or when the field is left, and may be emptied.
import { currentLanguage } from '../../messages/messages.ts';
import { readNumber } from '../../format.ts';
import { useDraft } from './draft.ts';
import './number-field.css';

interface NumberFieldProps {
  readonly id: string;
  readonly label: string;
  readonly unit: string;
  /** Null: the field is empty. */
  readonly value: number | null;
  readonly low: number;
  readonly high: number;
  /** Null: it was emptied. What is no number, or out of bounds, is not told. */
  onCommit(value: number | null): void;
}

export function NumberField({ id, label, unit, value, low, high, onCommit }: NumberFieldProps) {
  const shown = value === null ? '' : value.toLocaleString(currentLanguage(), { maximumSignificantDigits: 6, useGrouping: false });
  const draft = useDraft(shown, (text) => {
    const typed = readNumber(text);
    if (text.trim() === '') {
      if (value !== null) onCommit(null);
    } else if (typed !== null && typed >= low && typed <= high && typed !== value) onCommit(typed);
  });
  return (
    <span class="number-field">
      <label for={id}>{label}</label>
      <span class="number-field-box">
        <input
          id={id}
          type="text"
          inputMode="decimal"
          autocomplete="off"
          placeholder="–"
          {...draft}
        />
        <span class="number-field-unit">{unit}</span>
      </span>
    </span>
  );
}
