// Figures as people read them, in the language of the page.
import { currentLanguage, t } from './messages/messages.ts';

/** 12345 → `12,345`. */
export const formatCount = (value: number): string => value.toLocaleString(currentLanguage());

/** Bytes in the decimal units that download dialogs use: 1234567 → `1.23 MB`. */
export const formatBytes = (bytes: number): string => {
  if (bytes < 1000) return `${bytes} B`;
  const units = ['kB', 'MB', 'GB'];
  let value = bytes / 1000;
  let unit = 0;
  // 999.5 kB would be shown as 1000 kB.
  while (value >= 999.5 && unit < units.length - 1) {
    value /= 1000;
    unit += 1;
  }
  return `${threeDigits(value)} ${units[unit]}`;
};

/** A share of 1 as per cent with three significant digits at most: 0.1234 → `12.3 %`. */
export const formatShare = (share: number): string => {
  const percent = share * 100;
  if (share > 0 && percent < 0.001) return t('figure.below', { value: percentOf('0.001') });
  // A remainder just below 100 must not read as all of it.
  if (share < 1 && percent > 99.9) return t('figure.above', { value: percentOf('99.9') });
  return t('figure.percent', { value: threeDigits(percent) });
};

const percentOf = (figure: string): string => t('figure.percent', { value: Number(figure).toLocaleString(currentLanguage()) });

/** A length in model units with three significant digits, in powers of ten when it is very small or large. */
export const formatLength = (length: number): string => {
  if (length === 0) return '0';
  if (length < 1e-4 || length >= 1e6) {
    const [digits = '', exponent = ''] = length.toExponential(2).split('e');
    return `${Number(digits).toLocaleString(currentLanguage(), { minimumFractionDigits: 2 })} × 10${superscript(exponent)}`;
  }
  return threeDigits(length);
};

const superscript = (exponent: string): string =>
  [...exponent].map((sign) => (sign === '-' ? '⁻' : sign === '+' ? '' : ('⁰¹²³⁴⁵⁶⁷⁸⁹'[Number(sign)] ?? sign))).join('');

const threeDigits = (value: number): string =>
  value >= 100 ? formatCount(Math.round(value)) : value.toLocaleString(currentLanguage(), { maximumSignificantDigits: 3 });

/** A number as people type it, with a point or a comma before its fraction; null for what is none. */
export const readNumber = (text: string): number | null => {
  const plain = text.replace(/[\s\u00a0\u202f'’_]/g, '');
  const separators = plain.match(/[.,]/g) ?? [];
  // Of several different separators the last stands before a fraction; several of one kind set off thousands.
  const thousands = separators.length > 1 && separators.every((separator) => separator === separators[0]);
  const parts = plain.split(/[.,]/);
  const fraction = separators.length > 0 && !thousands ? `.${parts.pop() ?? ''}` : '';
  const joined = parts.join('') + fraction;
  return /^\d*\.?\d+$|^\d+\.$/.test(joined) ? Number(joined) : null;
};

/** Bits a second of a usual 4G connection, as browsers' tools throttle to. */
const FOURTH_GENERATION = 9e6;

/** How long `bytes` take over 4G: `0.4 s`. */
export const formatDownloadTime = (bytes: number): string => {
  const seconds = (bytes * 8) / FOURTH_GENERATION;
  return t('figure.seconds', { value: seconds >= 10 ? formatCount(Math.round(seconds)) : seconds.toLocaleString(currentLanguage(), { maximumFractionDigits: seconds < 1 ? 2 : 1 }) });
};
