//! The attributes while the mesh shrinks: values of merged wedges, gradients of the triangles that
//! a collapse changes.
//!
//! The gradient over a triangle is the same seen from each of its corners, so that a triangle is looked at once and what
//! it gives is added to all three. Where both ends of a collapsed edge have one wedge, which is the usual case, the
//! triangles before and after are looked at four at a time and their differences added to the vertices around. Other
//! vertices are taken up afresh from all their triangles.

use super::attributes::{AttributeField, HEAD, along};
use super::gradient::{Hats, Products, head_of};
use super::lanes::{Lanes, Lanes3, Mask, WIDTH};
use super::quadric::{QuadricLanes, Vec3, larger, smaller};
use super::topology::{NONE, Topology};

/// A neighbour of several wedges and more triangles than this is not taken up afresh: a few of them
/// have changed, and it would be each time that one of its many neighbours does.
const LONGEST_RING: usize = 256;

/// A collapse whose two ends had closed rings, done in the topology and not yet in the attributes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spliced<'a> {
    /// The merged ring: triangles of `from` up to slot `split`, then those of `into`.
    pub(super) ring: &'a [u32],
    pub(super) split: usize,
    /// Positions of the ring, which is followed by its beginning.
    pub(super) around: &'a [Lanes3],
}

/// An end of a collapsed edge, and where it was.
pub(super) type End = (u32, Vec3);

impl AttributeField {
    /// Takes up the triangles of which `v` is the first vertex, so that each is taken up once for all vertices.
    pub(super) fn take_up(&mut self, topology: &Topology, v: u32) {
        if self.only_record[v as usize] == NONE {
            self.refresh(topology, v);
        }
        let mut corners = std::mem::take(&mut self.scratch.corners);
        let mut sum = std::mem::take(&mut self.scratch.sums);
        corners.clear();
        topology.corners(v, &mut corners);
        for c in corners.iter().filter(|c| v < c.next && v < c.previous) {
            let records = self.records_of(topology, [v, c.next, c.previous], c.wedge);
            sum.clear();
            sum.resize(self.stride(), Lanes::splat(0.0));
            self.triangle(topology, [v, c.next, c.previous], records, &mut sum);
            for (w, record) in [v, c.next, c.previous].into_iter().zip(records) {
                // Vertices of several wedges take up their own.
                if self.only_record[w as usize] != NONE {
                    self.add(record, &sum);
                }
            }
        }
        self.scratch.corners = corners;
        self.scratch.sums = sum;
    }

    /// Sums of `v` from its triangles as they are.
    pub(super) fn refresh(&mut self, topology: &Topology, v: u32) {
        let mut corners = std::mem::take(&mut self.scratch.corners);
        let mut sum = std::mem::take(&mut self.scratch.sums);
        let mut records = std::mem::take(&mut self.scratch.records);
        corners.clear();
        records.clear();
        topology.corners(v, &mut corners);
        let only = self.only_record[v as usize];
        let main = if only == NONE { v } else { only };
        records.extend(corners.iter().map(|c| if only == NONE { self.record(v, c.wedge) } else { only }));
        for &record in records.iter().chain([&main]) {
            self.clear(record);
        }
        let mut matrix = [Lanes::splat(0.0); HEAD];
        for (c, &record) in corners.iter().zip(&records) {
            let [_, next, previous] = self.records_of(topology, [v, c.next, c.previous], c.wedge);
            sum.clear();
            sum.resize(self.stride(), Lanes::splat(0.0));
            self.triangle(topology, [v, c.next, c.previous], [record, next, previous], &mut sum);
            self.add(record, &sum);
            matrix = [matrix[0] + sum[0], matrix[1] + sum[1]];
        }
        if only == NONE {
            records.sort_unstable();
            records.dedup();
            for &record in &records {
                let followed = self.followed(record);
                matrix[0] = matrix[0] - Lanes::new([followed.xx, followed.xy, followed.xz, followed.yy]);
                matrix[1] = matrix[1] - Lanes::new([followed.yz, followed.zz, 0.0, 0.0]);
            }
            let area = self.area(v);
            let [yz, zz, ..] = matrix[1].to_array();
            let first = v as usize * self.stride();
            self.blocks[first] = matrix[0];
            self.blocks[first + 1] = Lanes::new([yz, zz, area, 0.0]);
        }
        self.scratch.corners = corners;
        self.scratch.sums = sum;
        self.scratch.records = records;
    }

    /// The records of a triangle's corners, the first of which has the wedge `wedge`.
    #[inline(always)]
    fn records_of(&self, topology: &Topology, [v, next, previous]: [u32; 3], wedge: u32) -> [u32; 3] {
        let only = self.only_record[v as usize];
        let own = if only == NONE { self.record(v, wedge) } else { only };
        [own, self.record_at(topology, next, previous, v), self.record_at(topology, previous, v, next)]
    }

    /// Sums of nothing; the values stay.
    fn clear(&mut self, record: u32) {
        let stride = self.stride();
        for (k, row) in self.blocks[record as usize * stride..][..stride].iter_mut().enumerate() {
            *row = Lanes::new([if k < HEAD { 0.0 } else { row.lane::<0>() }, 0.0, 0.0, 0.0]);
        }
    }

    /// Adds sums to a block.
    #[inline(always)]
    fn add(&mut self, record: u32, sums: &[Lanes]) {
        let first = record as usize * self.stride();
        for (row, &sum) in self.blocks[first..].iter_mut().zip(sums) {
            *row = *row + sum;
        }
    }

    /// What a triangle gives to the block of each of its corners.
    fn triangle(&self, topology: &Topology, corners: [u32; 3], records: [u32; 3], sums: &mut [Lanes]) {
        let [own, next, previous] = corners.map(|v| topology.vertices[v as usize].position());
        let hat = Hats::of(
            Lanes3::splat(next - own),
            Lanes3::splat(previous - own),
            Lanes::splat(1.0).at_most(Lanes::splat(1.0)),
        );
        let [l1, l2] = [hat.weighted_next, hat.weighted_previous];
        let [row1, row2] = [l1, l2].map(|l| Lanes::new([0.0, l.x.lane::<0>(), l.y.lane::<0>(), l.z.lane::<0>()]));
        let mut products = Products::default();
        let [own, next, previous] = records.map(|r| &self.block(r)[HEAD..]);
        for (((own, next), previous), sum) in own.iter().zip(next).zip(previous).zip(&mut sums[HEAD..]) {
            let s = own.lane::<0>();
            let (a, b) = (Lanes::splat(next.lane::<0>() - s), Lanes::splat(previous.lane::<0>() - s));
            products.add(a, b);
            *sum = row1 * a + row2 * b;
        }
        let [first, second] = head_of(&hat.outer(&products), hat.area);
        (sums[0], sums[1]) = (first[0], second[0]);
    }

    /// Follows a collapse that the topology has done: `from` is gone, `into` is where it is now.
    /// `merges` are the wedges that became one. Without `solve` the wedges of `into` keep their values.
    pub(super) fn follow(
        &mut self,
        topology: &Topology,
        spliced: Option<Spliced<'_>>,
        merges: &[(u32, u32)],
        (from, into): (End, End),
        solve: bool,
    ) {
        let plain = [(from.0, into.0)];
        let merges = if self.is_plain() { &plain[..] } else { merges };
        let single = |v: u32| self.only_record[v as usize] != NONE;
        if let (Some(spliced), true) = (spliced, single(from.0) && single(into.0)) {
            self.follow_spliced(topology, spliced, merges, (from, into), solve);
            return;
        }
        if solve {
            self.merge(topology, merges, (from, into));
        }
        let ring = topology.ring(into.0);
        let short = |v: u32| topology.vertices[v as usize].ring_length() <= LONGEST_RING;
        let near = ring.iter().copied().filter(|&v| v != NONE && short(v));
        let around = || [into.0].into_iter().chain(near.clone());
        around().for_each(|v| self.count_wedges(topology, v));
        around().for_each(|v| self.refresh(topology, v));
    }

    /// [`AttributeField::follow`] where both ends have one wedge: the triangles of the merged ring, four at a time.
    fn follow_spliced(
        &mut self,
        topology: &Topology,
        Spliced { ring, split, around }: Spliced<'_>,
        merges: &[(u32, u32)],
        (from, into): (End, End),
        solve: bool,
    ) {
        let (stride, length) = (self.stride(), ring.len());
        let batches = length.div_ceil(WIDTH);
        let mut values = std::mem::take(&mut self.scratch.values);
        values.clear();
        let [of_from, of_into] = [from.0, into.0].map(|v| self.only_record[v as usize]);
        for record in [of_from, of_into] {
            values.extend(self.block(record)[HEAD..].iter().map(|row| row.lane::<0>()));
        }
        if solve {
            self.merge(topology, merges, (from, into));
        }
        let now = topology.vertices[into.0 as usize].position();
        let mut sums = std::mem::take(&mut self.scratch.sums);
        sums.clear();
        // One for each triangle around, two for those that are gone, one for all that are new.
        sums.resize((batches * WIDTH + 3) * stride, Lanes::splat(0.0));
        let (differences, rest) = sums.split_at_mut(batches * WIDTH * stride);
        let (gone, whole) = rest.split_at_mut(2 * stride);
        let (last, until_split) = (Lanes::splat(length as f32 - 0.5), Lanes::splat(split as f32 - 0.5));
        let mut index = Lanes::new(Lanes::INDEX);
        for (batch, out) in differences.chunks_exact_mut(WIDTH * stride).enumerate() {
            let (a, b) = (around[batch], around[batch].followed_by(around[batch + 1]));
            let (counts, of_first) = (index.at_most(last), index.at_most(until_split));
            index = index + Lanes::splat(WIDTH as f32);
            let records: [[u32; 2]; WIDTH] = std::array::from_fn(|k| {
                let at = batch * WIDTH + k;
                let slot = |k: usize| ring[if k < length { k } else { k - length }];
                let (next, previous) =
                    (slot(if at < length { at } else { 0 }), slot(if at < length { at + 1 } else { 0 }));
                [self.record_at(topology, next, previous, into.0), self.record_at(topology, previous, into.0, next)]
            });
            let origin = Lanes3::select(of_first, Lanes3::splat(from.1), Lanes3::splat(into.1));
            let merged = Lanes3::splat(now);
            let (old, new) = (Hats::of(a - origin, b - origin, counts), Hats::of(a - merged, b - merged, counts));
            self.change_of_four((records, of_into), (&values, of_first), (&old, &new), (out, whole));
        }
        self.take_off_gone(topology, [ring[0], ring[split]], (from, into), &values, gone);
        self.scratch.values = values;

        self.clear(of_into);
        self.add(of_into, whole);
        self.hand_out(ring, split, differences, gone);
        self.scratch.sums = sums;
        for &v in ring {
            if self.only_record[v as usize] == NONE && topology.vertices[v as usize].ring_length() <= LONGEST_RING {
                self.count_wedges(topology, v);
                self.refresh(topology, v);
            }
        }
    }

    /// What four triangles of the merged ring give now above what they gave before, a block of `out` for each, and what
    /// they give now added to `whole`. `records` are those of their other two corners, `values` what the wedges of `from`
    /// and of `into` had; a triangle was of `from` where `of_first` says so. The hats are those before and now.
    #[inline(always)]
    fn change_of_four(
        &self,
        (records, of_into): ([[u32; 2]; WIDTH], u32),
        (values, of_first): (&[f32], Mask),
        (old, new): (&Hats, &Hats),
        (out, whole): (&mut [Lanes], &mut [Lanes]),
    ) {
        let (stride, components) = (self.stride(), self.layout.components);
        let blocks = records.map(|pair| pair.map(|record| self.block(record)));
        let (mut old_products, mut new_products) = (Products::default(), Products::default());
        let own = self.block(of_into);
        for k in 0..components {
            let value = |end: usize| Lanes::new(blocks.map(|pair| pair[end][HEAD + k].lane::<0>()));
            let (next, previous) = (value(0), value(1));
            let before = Lanes::select(of_first, Lanes::splat(values[k]), Lanes::splat(values[components + k]));
            let after = Lanes::splat(own[HEAD + k].lane::<0>());
            let was = old.gradient(&mut old_products, next - before, previous - before);
            let is = new.gradient(&mut new_products, next - after, previous - after);
            let change = is - was;
            let zero = Lanes::splat(0.0);
            for (lane, row) in Lanes::transpose([zero, change.x, change.y, change.z]).into_iter().enumerate() {
                out[lane * stride + HEAD + k] = row;
            }
            let [a, b, c, d] = Lanes::transpose([zero, is.x, is.y, is.z]);
            whole[HEAD + k] = whole[HEAD + k] + ((a + b) + (c + d));
        }
        let (was, is) = (old.outer(&old_products), new.outer(&new_products));
        let [first, second] = head_of(&is.minus(&was), new.area - old.area);
        for lane in 0..WIDTH {
            (out[lane * stride], out[lane * stride + 1]) = (first[lane], second[lane]);
        }
        let [first, second] = head_of(&is, new.area);
        for lane in 0..WIDTH {
            (whole[0], whole[1]) = (whole[0] + first[lane], whole[1] + second[lane]);
        }
    }

    /// Adds the changes of the triangles in `differences` to the vertices around, and `gone` to the third vertices of
    /// those that are gone. Vertices of several wedges are left out: they are taken up afresh.
    #[inline(always)]
    fn hand_out(&mut self, ring: &[u32], split: usize, differences: &[Lanes], gone: &[Lanes]) {
        let (stride, length) = (self.stride(), ring.len());
        for (i, &v) in ring.iter().enumerate() {
            let record = self.only_record[v as usize];
            if record == NONE {
                continue;
            }
            let before = if i == 0 { length - 1 } else { i - 1 };
            let first = record as usize * stride;
            let (previous, next) = (&differences[before * stride..][..stride], &differences[i * stride..][..stride]);
            for ((row, &previous), &next) in self.blocks[first..].iter_mut().zip(previous).zip(next) {
                *row = *row + (previous + next);
            }
            if i == 0 {
                self.add(record, &gone[..stride]);
            } else if i == split {
                self.add(record, &gone[stride..]);
            }
        }
    }

    /// Minus what the two triangles at the collapsed edge gave to their third vertices. `values` are those that the
    /// wedges of `from` and of `into` had.
    #[inline(always)]
    fn take_off_gone(
        &self,
        topology: &Topology,
        thirds: [u32; 2],
        (from, into): (End, End),
        values: &[f32],
        gone: &mut [Lanes],
    ) {
        let (stride, components) = (self.stride(), self.layout.components);
        let [a, b] = thirds.map(|v| topology.vertices[v as usize].position() - into.1);
        let everywhere = Lanes::splat(0.0).at_most(Lanes::splat(0.0));
        let hats = Hats::of(Lanes3::splat(from.1 - into.1), Lanes3::gather([a, b, a, b]), everywhere);
        let mut products = Products::default();
        // The values of a vertex of several wedges do not matter: it is taken up afresh.
        let [a, b] = thirds.map(|v| {
            let record = self.only_record[v as usize];
            self.block(if record == NONE { v } else { record })
        });
        for k in 0..components {
            let own = Lanes::splat(values[components + k]);
            let [a, b] = [a, b].map(|block| block[HEAD + k].lane::<0>());
            let g = hats.gradient(&mut products, Lanes::splat(values[k]) - own, Lanes::new([a, b, a, b]) - own);
            let zero = Lanes::splat(0.0);
            let rows = Lanes::transpose([zero, zero - g.x, zero - g.y, zero - g.z]);
            (gone[HEAD + k], gone[stride + HEAD + k]) = (rows[0], rows[1]);
        }
        let minus = QuadricLanes::zero().minus(&hats.outer(&products));
        let [first, second] = head_of(&minus, Lanes::splat(0.0) - hats.area);
        (gone[0], gone[1]) = (first[0], second[0]);
        (gone[stride], gone[stride + 1]) = (first[1], second[1]);
    }

    /// The values of the wedges that merge, at the merged position.
    fn merge(&mut self, topology: &Topology, merges: &[(u32, u32)], (from, into): (End, End)) {
        let now = topology.vertices[into.0 as usize].position();
        let (du, dv) = (now - from.1, now - into.1);
        let components = self.layout.components;
        let mut merged = std::mem::take(&mut self.scratch.merged);
        merged.clear();
        for &(a, b) in merges {
            let (a, b) = (self.record(from.0, a), self.record(into.0, b));
            let (wa, wb) = (self.area(a), self.area(b));
            let inverse = if wa + wb > 0.0 { 1.0 / (wa + wb) } else { 0.0 };
            let shares = if wa + wb > 0.0 { [wa * inverse, wb * inverse] } else { [0.5; 2] };
            let rows = self.block(a)[HEAD..].iter().zip(&self.block(b)[HEAD..]);
            merged.extend(rows.map(|(&a, &b)| {
                let ([sa, ga], [sb, gb]) = (along(a, du), along(b, dv));
                sa * shares[0] + sb * shares[1] + (ga + gb) * inverse
            }));
        }
        for (&(_, wedge), values) in merges.iter().zip(merged.chunks_exact_mut(components)) {
            if let Some((start, unit)) = self.layout.normal {
                let normal = &mut values[start..start + 3];
                let length = normal.iter().map(|c| c * c).sum::<f32>().sqrt();
                if length > 0.0 {
                    normal.iter_mut().for_each(|c| *c *= unit / length);
                }
            }
            if let Some((start, length, one)) = self.layout.color {
                values[start..start + length].iter_mut().for_each(|c| *c = smaller(larger(*c, 0.0), one));
            }
            let first = self.record(into.0, wedge) as usize * self.stride() + HEAD;
            for (row, &value) in self.blocks[first..].iter_mut().zip(&*values) {
                let [_, x, y, z] = row.to_array();
                *row = Lanes::new([value, x, y, z]);
            }
        }
        self.scratch.merged = merged;
    }

    /// Appends the values of a wedge of `v`, which is of set `set`, in the units of the file.
    pub(super) fn push_values(&self, (v, wedge, set): (u32, u32, usize), out: &mut Vec<f32>) {
        let rows = &self.block(self.record(v, wedge))[HEAD..];
        let first = out.len();
        out.resize(first + rows.len(), 0.0);
        for p in &self.layout.sets[set] {
            for k in p.start..p.start + p.length {
                out[first + k] = rows[k].lane::<0>() / p.weight;
            }
        }
    }
}
