// Records that other tools hold, measured once with the same meter and written down: they are no npm packages.

/**
 * CGAL's Lindstrom–Turk edge collapse (1998), the lowest mean deviation that was found in the field: mean symmetric
 * distance in % of the diagonal, 400,000 samples each way, at 10 and 1 % of the triangles.
 */
export const lindstromTurkMeans = {
  'stanford-bunny': { 0.1: 0.01424, 0.01: 0.099 },
  fandisk: { 0.1: 0.00171, 0.01: 0.0819 },
  'rocker-arm': { 0.1: 0.022, 0.01: 0.19 },
  beast: { 0.1: 0.0165, 0.01: 0.116 },
  nefertiti: { 0.1: 0.00698, 0.01: 0.0313 },
  igea: { 0.1: 0.00436, 0.01: 0.0303 },
};

/** The lowest maximum that any tool reached at 10 %, same unit. */
export const lowestMaxima = {
  'stanford-bunny': 0.18,
  fandisk: 0.036,
  'rocker-arm': 0.33,
  beast: 0.22,
  nefertiti: 0.135,
  igea: 0.065,
};
