// The shapes that callers pass in and get back, shared by the document, its worker and the command line.
export type * from './types/document.js';
export type * from './types/levels.js';
export type * from './types/arrays.js';
export type * from './types/run_options.js';
export type * from './types/write_options.js';
