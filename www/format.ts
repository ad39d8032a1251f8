// Figures as people read them.

const counts = new Intl.NumberFormat('en');

/** 12345 → `12,345`. */
export const formatCount = (value: number): string => counts.format(value);

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
  if (share === 0) return '0 %';
  const percent = share * 100;
  if (percent < 0.001) return '< 0.001 %';
  // A remainder just below 100 must not read as all of it.
  if (share < 1 && percent > 99.9) return '> 99.9 %';
  return `${threeDigits(percent)} %`;
};

/** A length in model units with three significant digits, in powers of ten when it is very small or large. */
export const formatLength = (length: number): string => {
  if (length === 0) return '0';
  if (length < 1e-4 || length >= 1e6) return length.toExponential(2).replace('e-', ' × 10⁻').replace('e+', ' × 10').replace(/(10⁻?)(\d+)$/, (_, base: string, digits: string) => base + superscript(digits));
  return threeDigits(length);
};

const superscript = (digits: string): string => [...digits].map((digit) => '⁰¹²³⁴⁵⁶⁷⁸⁹'[Number(digit)] ?? digit).join('');

const threeDigits = (value: number): string => {
  if (value >= 100) return counts.format(Math.round(value));
  return String(Number(value.toPrecision(3)));
};
