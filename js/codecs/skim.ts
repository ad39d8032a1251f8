// The few members of a JSON object that somebody looks at: of a large text the rest takes long to parse and much memory.

/**
 * `text`, a JSON object, with null for every member of it that is not in `wanted`. What is no JSON stays none, unless the fault
 * is in a member that goes.
 */
export function onlyMembers(text: string, wanted: ReadonlySet<string>): string {
  const kept: string[] = [];
  let [depth, key, value, from] = [0, '', -1, 0];
  for (let at = 0; at < text.length; at += 1) {
    switch (text.charCodeAt(at)) {
      case 0x22: {
        const end = endOfString(text, at);
        if (depth === 1 && value < 0) key = text.slice(at + 1, end);
        at = end;
        break;
      }
      case 0x3a: // :
        if (depth === 1) value = at + 1;
        break;
      case 0x7b: // {
      case 0x5b: // [
        depth += 1;
        break;
      case 0x7d: // }
      case 0x5d: // ]
      case 0x2c: // ,
        if (depth === 1 && value >= 0 && !wanted.has(key)) {
          kept.push(text.slice(from, value), 'null');
          from = at;
        }
        if (depth === 1) value = -1;
        if (text[at] !== ',') depth -= 1;
        break;
    }
  }
  kept.push(text.slice(from));
  return kept.join('');
}

/** Where the string that begins at `start` has its second quote; the end of `text` if it has none. */
function endOfString(text: string, start: number): number {
  for (let at = start + 1; at < text.length; at += 1) {
    const sign = text.charCodeAt(at);
    if (sign === 0x22) return at;
    if (sign === 0x5c) at += 1;
  }
  return text.length;
}
