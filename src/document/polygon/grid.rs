//! A uniform grid over points of the plane, to find those near a triangle.

/// Point numbers by cell; as many cells as points, one for a few.
#[derive(Debug, Default)]
pub(super) struct Grid {
    low: [f64; 2],
    cells_per_unit: [f64; 2],
    side: usize,
    /// `items[starts[cell]..starts[cell + 1]]` are the points of a cell.
    starts: Vec<usize>,
    items: Vec<usize>,
}

/// Up to this many points, walking cells costs more than testing them all.
const SINGLE_CELL: usize = 32;

impl Grid {
    /// Takes up the points that are `chosen`.
    pub(super) fn fill(&mut self, points: &[[f64; 2]], chosen: &[bool]) {
        let count = chosen.iter().filter(|&&is| is).count();
        self.side = if count <= SINGLE_CELL { 1 } else { count.isqrt() };
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in points {
            for axis in 0..2 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        self.low = low;
        #[allow(clippy::cast_precision_loss)] // a few thousand
        let side = self.side as f64;
        self.cells_per_unit =
            [0, 1].map(|axis| if high[axis] > low[axis] { side / (high[axis] - low[axis]) } else { 0.0 });

        // Count, sum up, fill: `starts` ends one cell ahead and comes back while filling.
        self.starts.clear();
        self.starts.resize(self.side * self.side + 1, 0);
        let chosen_points = || (0..points.len()).filter(|&i| chosen[i]);
        for i in chosen_points() {
            let cell = self.cell(points[i]);
            self.starts[cell] += 1;
        }
        let mut sum = 0;
        for start in &mut self.starts {
            sum += *start;
            *start = sum;
        }
        self.items.clear();
        self.items.resize(count, 0);
        for i in chosen_points() {
            let cell = self.cell(points[i]);
            self.starts[cell] -= 1;
            self.items[self.starts[cell]] = i;
        }
    }

    /// Whether `test` holds for every point in the cells that the triangle's box touches; adds the
    /// cells and points looked at to `steps`.
    pub(super) fn all_near(
        &self,
        triangle: [[f64; 2]; 3],
        steps: &mut usize,
        mut test: impl FnMut(usize) -> bool,
    ) -> bool {
        let range = |axis: usize| {
            let along = triangle.map(|point| self.coordinate(point, axis));
            let [a, b, c] = along;
            a.min(b).min(c)..=a.max(b).max(c)
        };
        for y in range(1) {
            let (row, columns) = (y * self.side, range(0));
            let items = self.starts[row + columns.start()]..self.starts[row + columns.end() + 1];
            for &i in &self.items[items] {
                *steps += 1;
                if !test(i) {
                    return false;
                }
            }
            *steps += 1;
        }
        true
    }

    fn cell(&self, point: [f64; 2]) -> usize {
        self.coordinate(point, 1) * self.side + self.coordinate(point, 0)
    }

    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // saturates, and stays on the grid
    fn coordinate(&self, point: [f64; 2], axis: usize) -> usize {
        (((point[axis] - self.low[axis]) * self.cells_per_unit[axis]) as usize).min(self.side - 1)
    }
}
