// What the benches print: tables, and the goals with `met` or `missed`.

/** A number with `digits` decimals, or a dash for what was not measured. */
export function shown(value, digits = 3) {
  if (value === undefined || value === null) return '–';
  return typeof value === 'number' ? value.toFixed(digits) : String(value);
}

/** Prints `rows` of text cells under `header`, the first column to the left. */
export function printTable(title, header, rows) {
  const widths = header.map((name, at) => Math.max(...[name, ...rows.map((row) => row[at])].map((cell) => cell.length)));
  const line = (cells) => cells.map((cell, at) => (at === 0 ? cell.padEnd(widths[at]) : cell.padStart(widths[at]))).join('  ');
  console.log(`\n${title}`);
  console.log(line(header));
  for (const row of rows) console.log(line(row));
}

/** A goal: `value` must not be above `limit`. A value that was not measured is neither met nor missed. */
export const atMost = (text, value, limit) => ({ text, value, limit, met: value === undefined ? undefined : value <= limit });

/** A goal: no case may be listed in `failures`; `count` cases were looked at. */
export const none = (text, failures, count) => ({
  text,
  value: count === 0 ? undefined : failures.length,
  limit: 0,
  met: count === 0 ? undefined : failures.length === 0,
  of: count,
  failures,
});

/** Prints the goals, one a line, with the cases that failed. */
export function printGoals(title, goals) {
  const rows = goals.map(({ text, value, limit, met, of }) => [
    text,
    of === undefined ? shown(value) : `${shown(value, 0)} of ${of}`,
    `≤ ${limit}`,
    met === undefined ? 'not measured' : met ? 'met' : 'MISSED',
  ]);
  printTable(title, ['goal', 'value', 'limit', ''], rows);
  for (const { text, failures } of goals) {
    if (failures?.length > 0) console.log(`  ${text}: ${failures.join('; ')}`);
  }
}
