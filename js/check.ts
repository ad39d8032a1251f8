// The check that every call makes first: no option that it does not know.

import { invalidArgument } from './errors.js';

/** Throws `invalid-argument` unless `options` is an object with no other names than `names`. */
export function checkNames(options: unknown, names: readonly string[], what = 'options'): void {
  if (typeof options !== 'object' || options === null) throw invalidArgument(what, 'must be an object');
  for (const name of Object.keys(options)) {
    if (!names.includes(name)) throw invalidArgument(name, `unknown option; known are ${names.join(', ')}`);
  }
}
