//! `CollapseSequence`: the recorded history of one run, from which every level is extracted.

/// Why a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StopReason {
    /// The triangle count was reached.
    Target,
    /// The next collapse would exceed the error.
    Error,
    /// No legal collapse is left.
    Constraints,
    /// The owner had no more time.
    Time,
}

impl StopReason {
    /// The stable name in reports.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Target => "target",
            Self::Error => "error",
            Self::Constraints => "constraints",
            Self::Time => "time",
        }
    }
}

/// How many of the edges that are left when a run ends are blocked by what; each edge counts once.
///
/// An edge belongs to the first reason that stands against it, in the order of the sweep: the kinds of its ends and
/// their lines, the error, the link condition, the flip test.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Blockers {
    /// Between two vertices on seams (of texture coordinates, colours, skins or materials), but not along one seam.
    pub seam: usize,
    /// At a vertex where seams meet, end or reach a border: one of them would tear.
    pub corner: usize,
    /// Between two vertices on open borders, but not along the border.
    pub border: usize,
    /// At a vertex where more than two triangles meet in an edge, or several fans in a point.
    pub non_manifold: usize,
    /// At a vertex that may not move.
    pub locked: usize,
    /// The link condition: the surface would be connected in another way, or a part would vanish.
    pub topology: usize,
    /// A triangle would turn over or become degenerate, wherever the merged vertex were put.
    pub flip: usize,
    /// The estimated error would exceed the limit.
    pub error: usize,
    /// Nothing stands against the edge by itself.
    pub other: usize,
}

impl Blockers {
    /// All edges that were counted.
    #[must_use]
    pub fn total(&self) -> usize {
        self.seam
            + self.corner
            + self.border
            + self.non_manifold
            + self.locked
            + self.topology
            + self.flip
            + self.error
            + self.other
    }
}

/// One edge collapse: vertex `from` goes into vertex `into`, which moves to `position`.
/// Vertices are named by the wedge that the weld chose to represent them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Collapse {
    /// The vertex that vanishes.
    pub from: u32,
    /// The vertex that stays.
    pub into: u32,
    /// Where it stays, in the part's local space.
    pub position: [f32; 3],
    /// Running maximum of the estimated deviation after this collapse, in world units.
    pub error: f32,
}

/// The history of one run over one [`crate::mesh::Mesh`]: 24 bytes a collapse, and more only for
/// the collapses that are out of the ordinary.
#[derive(Debug, Clone, PartialEq)]
pub struct CollapseSequence {
    /// In the order they were done; `error` never falls.
    pub collapses: Vec<Collapse>,
    /// How many triangles are left after each collapse.
    pub triangle_counts: TriangleCounts,
    /// Which wedges merge at each collapse.
    pub wedge_merges: WedgeMerges,
    /// Vertex of each wedge (the weld), named by one of its wedges.
    pub vertex_of_wedge: Vec<u32>,
    /// Wedges that are the same as another of their vertex in every attribute, and which: at the first
    /// collapse all of them merge into that one.
    pub duplicates: Vec<(u32, u32)>,
    /// Triangles at the start, degenerate ones left out.
    pub initial_triangle_count: usize,
    /// Why the run ended.
    pub stop_reason: StopReason,
    /// What blocks the edges that are left, if it ended for [`StopReason::Constraints`] or [`StopReason::Error`]; else
    /// nothing is counted.
    pub blockers: Blockers,
    /// Positions at the last level of vertices that were fitted to the original after the last
    /// collapse, named as in [`Collapse`]; often empty.
    pub fitted: Vec<(u32, [f32; 3])>,
    /// Values of merged wedges where they do not follow from blending.
    pub solved: SolvedValues,
}

/// Attribute values of merged wedges that were solved for together with the position. What is not
/// among them is blended along the edge.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SolvedValues {
    /// By wedge set: which attributes, and where in the values of a merge each begins.
    pub layouts: Vec<Vec<SolvedAttribute>>,
    /// Numbers for each merge; 0 if nothing was solved.
    pub components: usize,
    /// `components` numbers for each wedge merge, in the order of the merges.
    pub values: Vec<f32>,
}

/// One attribute among the values of a merge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SolvedAttribute {
    /// Index in the attributes of the wedge set.
    pub attribute: usize,
    /// Its first number among those of a merge.
    pub start: usize,
    /// How many numbers; the attribute's components, or fewer.
    pub length: usize,
}

impl SolvedValues {
    /// The numbers of wedge merge number `ordinal` of all; none if nothing was solved.
    #[must_use]
    pub fn of(&self, ordinal: usize) -> &[f32] {
        self.values.get(ordinal * self.components..(ordinal + 1) * self.components).unwrap_or(&[])
    }
}

/// Triangles left after each collapse. Almost every collapse removes two; only the others are kept.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct TriangleCounts {
    initial: u32,
    collapses: u32,
    /// Left after all of them.
    left: u32,
    /// Collapses that do not remove two, by index, with the count after them.
    exceptions: Vec<(u32, u32)>,
}

impl TriangleCounts {
    /// No collapse yet.
    #[must_use]
    pub fn new(initial: usize) -> Self {
        Self { initial: initial as u32, left: initial as u32, ..Self::default() }
    }

    /// One more collapse, after which so many are `left`.
    pub fn push(&mut self, left: usize) {
        let left = left as u32;
        if left.saturating_add(2) != self.left {
            self.exceptions.push((self.collapses, left));
        }
        self.left = left;
        self.collapses += 1;
    }

    /// Number of collapses.
    #[must_use]
    pub fn len(&self) -> usize {
        self.collapses as usize
    }

    /// Whether there is no collapse.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.collapses == 0
    }

    /// Triangles left after the first `count` collapses, at most [`TriangleCounts::len`] of them.
    #[must_use]
    pub fn after(&self, count: usize) -> usize {
        let known = self.exceptions.partition_point(|&(collapse, _)| (collapse as usize) < count);
        let (since, left) = match known.checked_sub(1) {
            Some(last) => (self.exceptions[last].0 as usize + 1, self.exceptions[last].1),
            None => (0, self.initial),
        };
        (left as usize).saturating_sub(2 * (count - since))
    }

    /// The fewest collapses after which at most `most` triangles are left; all if there are always more.
    #[must_use]
    pub fn collapses_to(&self, most: usize) -> usize {
        let (mut low, mut high) = (0, self.len());
        while low < high {
            let middle = low.midpoint(high);
            if self.after(middle) > most {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        low
    }

    /// Bytes on the heap.
    #[must_use]
    pub fn byte_count(&self) -> usize {
        size_of_val(self.exceptions.as_slice())
    }
}

/// Which wedges merge at each collapse. Almost always it is just the one that names the vanishing
/// vertex into the one that names the staying vertex; only the other cases are kept.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct WedgeMerges {
    /// Collapses with other merges, by index, with the end of theirs in `merges`.
    exceptions: Vec<(u32, u32)>,
    merges: Vec<(u32, u32)>,
}

impl WedgeMerges {
    /// The `merges` of collapse number `index`, which is above all that were pushed, of the vertex
    /// named `from` into the one named `into`.
    pub fn push(&mut self, index: usize, (from, into): (u32, u32), merges: &[(u32, u32)]) {
        if merges != [(from, into)] {
            self.merges.extend_from_slice(merges);
            self.exceptions.push((index as u32, self.merges.len() as u32));
        }
    }

    /// The merges `(from, into)` of collapse number `index`, if they are not the usual one.
    #[must_use]
    pub fn unusual(&self, index: usize) -> Option<&[(u32, u32)]> {
        let at = self.exceptions.binary_search_by_key(&(index as u32), |e| e.0).ok()?;
        let start = at.checked_sub(1).map_or(0, |before| self.exceptions[before].1);
        self.merges.get(start as usize..self.exceptions[at].1 as usize)
    }

    /// How many merges the collapses before number `index` have.
    #[must_use]
    pub fn count_before(&self, index: usize) -> usize {
        let at = self.exceptions.partition_point(|&(collapse, _)| (collapse as usize) < index);
        index - at + at.checked_sub(1).map_or(0, |before| self.exceptions[before].1 as usize)
    }

    /// Bytes on the heap.
    #[must_use]
    pub fn byte_count(&self) -> usize {
        size_of_val(self.exceptions.as_slice()) + size_of_val(self.merges.as_slice())
    }
}

impl CollapseSequence {
    /// The wedge merges `(from, into)` of each collapse from number `first` on.
    pub fn merges_from(&self, first: usize) -> impl Iterator<Item = impl Iterator<Item = (u32, u32)>> {
        let WedgeMerges { exceptions, merges } = &self.wedge_merges;
        let mut at = exceptions.partition_point(|&(index, _)| (index as usize) < first);
        self.collapses[first.min(self.collapses.len())..].iter().enumerate().map(move |(i, collapse)| {
            let mut own = None;
            let mut others: &[(u32, u32)] = &[];
            match exceptions.get(at) {
                Some(&(index, end)) if index as usize == first + i => {
                    let start = at.checked_sub(1).map_or(0, |before| exceptions[before].1);
                    others = &merges[start as usize..end as usize];
                    at += 1;
                }
                _ => own = Some((collapse.from, collapse.into)),
            }
            own.into_iter().chain(others.iter().copied())
        })
    }

    /// Bytes that the record of the collapses takes on the heap.
    #[must_use]
    pub fn record_bytes(&self) -> usize {
        size_of_val(self.collapses.as_slice())
            + self.triangle_counts.byte_count()
            + self.wedge_merges.byte_count()
            + size_of_val(self.solved.values.as_slice())
    }
}
