// The page's one state value and the pure transitions between its values; nothing here fetches, draws or waits.
export type * from './model.ts';
export * from './state/value.ts';
export * from './state/opening.ts';
export * from './state/levels.ts';
export * from './state/steps.ts';
export * from './state/view.ts';
