//! The statements of an OBJ file as flat arrays: elements, faces with absolute indices, names.
//!
//! One pass over the bytes. Faces are kept as written; which of their indices exist, and how
//! polygons become triangles, is decided in [`super::assemble`] when all elements are known, since
//! a face may name elements that come later.

use std::collections::{BTreeMap, BTreeSet};

use super::notice;
use crate::document::notice::{Kind, Notices, SMALL_FACE};
use crate::document::scan::{Fault, Scanner};
use crate::error::{Error, ErrorCode};

/// Stands for "no texture coordinate" or "no normal" in a corner.
const ABSENT: u32 = u32::MAX;

/// Which attributes all corners of a face have: [`HAS_TEXCOORD`] and [`HAS_NORMAL`].
pub(super) type Signature = u8;
/// Every corner names a `vt`.
pub(super) const HAS_TEXCOORD: Signature = 1;
/// Every corner names a `vn`.
pub(super) const HAS_NORMAL: Signature = 2;

/// What separates triangles into groups; names by their number in [`Statements::names`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct GroupKey {
    pub(super) object: u32,
    pub(super) group: u32,
    pub(super) material: u32,
    pub(super) signature: Signature,
}

/// Smoothing groups met in one group.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Smoothing {
    /// The same for all faces: `s` as written, by its number in [`Statements::names`]; 0 for off.
    One(u32),
    /// Several.
    Mixed,
}

/// Consecutive faces of one group with the same number of corners.
#[derive(Debug)]
pub(super) struct Run {
    pub(super) group: usize,
    pub(super) corners_per_face: usize,
    pub(super) face_count: usize,
}

/// The content of the file.
#[derive(Debug, Default)]
pub(super) struct Statements {
    pub(super) positions: Vec<[f32; 3]>,
    /// Empty if no `v` has a colour, else one for each position.
    pub(super) colors: Vec<[f32; 4]>,
    pub(super) texcoords: Vec<[f32; 2]>,
    pub(super) normals: Vec<[f32; 3]>,
    pub(super) runs: Vec<Run>,
    /// Position index of every corner of every face, in the order of `runs`.
    pub(super) corner_positions: Vec<u32>,
    /// The same for the faces that have texture coordinates.
    pub(super) corner_texcoords: Vec<u32>,
    /// The same for the faces that have normals.
    pub(super) corner_normals: Vec<u32>,
    /// The line of every face.
    pub(super) face_lines: Vec<u32>,
    /// Groups in order of first appearance.
    pub(super) groups: Vec<(GroupKey, Smoothing)>,
    /// Distinct names; number 0 is the empty one, which stands for none.
    pub(super) names: Vec<String>,
    pub(super) material_libraries: Vec<String>,
    /// How many texture coordinates and normals there must be for the indices of corners.
    used: [usize; 2],
    pub(super) notices: Notices,
}

/// Reads the statements of `bytes`; `name` is for the places of errors.
///
/// Indices of positions may lie beyond the last one; those of texture coordinates and normals do
/// not: some exporters write them without the elements, so they count as absent.
pub(super) fn parse(name: &str, bytes: &[u8]) -> Result<Statements, Error> {
    let statements = parse_within(name, bytes, [usize::MAX; 2])?;
    let counts = [statements.texcoords.len(), statements.normals.len()];
    if statements.used[0] <= counts[0] && statements.used[1] <= counts[1] {
        return Ok(statements);
    }
    // Known only now, and it changes which group a face belongs to: once more.
    parse_within(name, bytes, counts)
}

fn parse_within(name: &str, bytes: &[u8], attribute_counts: [usize; 2]) -> Result<Statements, Error> {
    let mut parser = Parser::new(name, bytes, attribute_counts);
    match parser.run() {
        Ok(()) => Ok(parser.out),
        Err((fault, statement)) => {
            let (code, reason) = match fault {
                // The file was cut in the middle of a statement.
                Fault::Missing if parser.scan.is_at_end() => (ErrorCode::Truncated, "the file ends here"),
                Fault::Missing => (ErrorCode::Syntax, "a number is missing or incomplete"),
                Fault::NotANumber => (ErrorCode::Syntax, "not a number"),
                Fault::NotFinite => (ErrorCode::NotFinite, "not a finite number"),
                Fault::OutOfRange => {
                    (ErrorCode::OutOfRange, "indices count from 1, negative ones back from the last element")
                }
            };
            Err(Error::new(code, format!("{name}:{}", parser.scan.line()), format!("in `{statement}`: {reason}")))
        }
    }
}

struct Parser<'a> {
    /// Of the file, for places.
    name: &'a str,
    scan: Scanner<'a>,
    /// Indices of texture coordinates and normals from here on count as absent.
    attribute_counts: [usize; 2],
    out: Statements,
    name_numbers: BTreeMap<String, u32>,
    known_libraries: BTreeSet<String>,
    /// Names and smoothing in force.
    object: u32,
    group: u32,
    material: u32,
    smoothing: u32,
    group_numbers: BTreeMap<GroupKey, usize>,
    /// The group of each signature under the names in force, once looked up.
    current_groups: [Option<usize>; 4],
    /// `[v, vt, vn]` of the face being read.
    face: Vec<[u32; 3]>,
}

type Step<T = ()> = Result<T, (Fault, &'static str)>;

impl<'a> Parser<'a> {
    fn new(name: &'a str, bytes: &'a [u8], attribute_counts: [usize; 2]) -> Self {
        let mut parser = Self {
            name,
            scan: Scanner::new(bytes),
            attribute_counts,
            out: Statements::default(),
            name_numbers: BTreeMap::new(),
            known_libraries: BTreeSet::new(),
            object: 0,
            group: 0,
            material: 0,
            smoothing: 0,
            group_numbers: BTreeMap::new(),
            current_groups: [None; 4],
            face: Vec::new(),
        };
        parser.intern(String::new());
        parser
    }

    fn run(&mut self) -> Step {
        while !self.scan.is_at_end() {
            self.scan.skip_blanks();
            if !self.scan.is_at_line_end() {
                self.statement()?;
            }
            self.scan.finish_line();
        }
        Ok(())
    }

    /// Notes one more of a kind, in a line.
    #[cold]
    fn note(&mut self, kind: &'static Kind, line: usize) {
        self.out.notices.count(kind, &|| format!("{}:{line}", self.name));
    }

    fn statement(&mut self) -> Step {
        match self.scan.word() {
            b"v" => return self.position(),
            b"f" => return self.face(),
            b"vt" => return self.texcoord(),
            b"vn" => return self.normal(),
            b"o" => self.object = self.name(),
            b"g" => self.group = self.name(),
            b"usemtl" => self.material = self.name(),
            b"s" => {
                let number = self.name();
                let is_off = matches!(self.out.names[number as usize].as_str(), "off" | "0");
                self.smoothing = if is_off { 0 } else { number };
            }
            b"mtllib" => self.material_library(),
            keyword => {
                let line = self.scan.line();
                self.note(notice::of_ignored_statement(keyword), line);
            }
        }
        Ok(())
    }

    /// `v x y z`, `v x y z w`, `v x y z r g b`, `v x y z r g b a`.
    #[inline]
    fn position(&mut self) -> Step {
        let fail = |fault| (fault, "v");
        let mut position = [0.0; 3];
        for value in &mut position {
            *value = self.scan.number().map_err(fail)?;
        }
        self.out.positions.push(position);
        self.scan.skip_blanks();
        if self.scan.is_at_line_end() {
            if !self.out.colors.is_empty() {
                self.out.colors.push([1.0; 4]);
            }
            return Ok(());
        }
        let mut rest = [1.0; 4];
        let count = self.optional_numbers(&mut rest).map_err(fail)?;
        let line = self.scan.line();
        if count >= 3 {
            self.out.colors.resize(self.out.positions.len() - 1, [1.0; 4]);
            self.out.colors.push(rest);
        } else {
            if count == 2 {
                self.note(&notice::EXTRA_NUMBERS, line);
            } else if rest[0].to_bits() != 1.0_f32.to_bits() {
                self.note(&notice::VERTEX_WEIGHT, line);
            }
            if !self.out.colors.is_empty() {
                self.out.colors.push([1.0; 4]);
            }
        }
        Ok(())
    }

    /// `vt u`, `vt u v`, `vt u v w`.
    #[inline]
    fn texcoord(&mut self) -> Step {
        let fail = |fault| (fault, "vt");
        let u = self.scan.number().map_err(fail)?;
        let mut rest = [0.0; 2];
        self.optional_numbers(&mut rest).map_err(fail)?;
        if rest[1] != 0.0 {
            let line = self.scan.line();
            self.note(&notice::TEXTURE_DEPTH, line);
        }
        self.out.texcoords.push([u, rest[0]]);
        Ok(())
    }

    /// `vn x y z`.
    #[inline]
    fn normal(&mut self) -> Step {
        let mut normal = [0.0; 3];
        for value in &mut normal {
            *value = self.scan.number().map_err(|fault| (fault, "vn"))?;
        }
        self.optional_numbers(&mut []).map_err(|fault| (fault, "vn"))?;
        self.out.normals.push(normal);
        Ok(())
    }

    /// Reads as many of `values` as the line has and returns how many; counts what exceeds them.
    fn optional_numbers(&mut self, values: &mut [f32]) -> Result<usize, Fault> {
        for (count, value) in values.iter_mut().enumerate() {
            self.scan.skip_blanks();
            if self.scan.is_at_line_end() {
                return Ok(count);
            }
            *value = self.scan.number()?;
        }
        self.scan.skip_blanks();
        if !self.scan.is_at_line_end() {
            let line = self.scan.line();
            self.note(&notice::EXTRA_NUMBERS, line);
        }
        Ok(values.len())
    }

    /// `f` with corners `v`, `v/vt`, `v//vn` or `v/vt/vn`, possibly mixed.
    #[inline]
    fn face(&mut self) -> Step {
        let line = self.scan.line();
        let (all, any) = self.corners().map_err(|fault| (fault, "f"))?;
        if self.face.len() < 3 {
            if self.scan.is_at_end() {
                return Err((Fault::Missing, "f"));
            }
            self.note(&SMALL_FACE, line);
            return Ok(());
        }
        if all != any {
            self.note(&notice::MIXED_CORNERS, line);
        }
        let group = match self.current_groups[usize::from(all)] {
            Some(group) => group,
            None => self.enter_group(all),
        };
        let out = &mut self.out;
        match out.runs.last_mut() {
            Some(run) if run.group == group && run.corners_per_face == self.face.len() => run.face_count += 1,
            _ => out.runs.push(Run { group, corners_per_face: self.face.len(), face_count: 1 }),
        }
        out.face_lines.push(u32::try_from(line).unwrap_or(u32::MAX));
        out.corner_positions.extend(self.face.iter().map(|corner| corner[0]));
        if all & HAS_TEXCOORD != 0 {
            out.corner_texcoords.extend(self.face.iter().map(|corner| corner[1]));
        }
        if all & HAS_NORMAL != 0 {
            out.corner_normals.extend(self.face.iter().map(|corner| corner[2]));
        }
        Ok(())
    }

    /// Reads corners into `self.face`; the attributes that all, and that any of them have.
    #[inline]
    fn corners(&mut self) -> Result<(Signature, Signature), Fault> {
        self.face.clear();
        let (mut all, mut any) = (HAS_TEXCOORD | HAS_NORMAL, 0);
        let (scan, out) = (&mut self.scan, &mut self.out);
        let mut attribute_index = |scan: &mut Scanner<'_>, kind: usize, count: usize| match scan.index(count) {
            Ok(index) if (index as usize) < self.attribute_counts[kind] => {
                out.used[kind] = out.used[kind].max(index as usize + 1);
                Ok(index)
            }
            Ok(_) | Err(Fault::OutOfRange) => {
                out.notices.count(&notice::DANGLING_INDEX, &|| format!("{}:{}", self.name, scan.line()));
                Ok(ABSENT)
            }
            Err(fault) => Err(fault),
        };
        loop {
            scan.skip_blanks();
            if scan.is_at_line_end() {
                return Ok((all, any));
            }
            let mut corner = [scan.index(out.positions.len())?, ABSENT, ABSENT];
            let mut signature = 0;
            if scan.skip_slash() {
                if scan.has_index() {
                    corner[1] = attribute_index(scan, 0, out.texcoords.len())?;
                }
                if scan.skip_slash() && scan.has_index() {
                    corner[2] = attribute_index(scan, 1, out.normals.len())?;
                }
                signature |= if corner[1] == ABSENT { 0 } else { HAS_TEXCOORD };
                signature |= if corner[2] == ABSENT { 0 } else { HAS_NORMAL };
            }
            if !scan.is_at_corner_end() {
                return Err(Fault::NotANumber);
            }
            all &= signature;
            any |= signature;
            self.face.push(corner);
        }
    }

    /// The group of the names in force and `signature`, a new one if there is none.
    #[cold]
    fn enter_group(&mut self, signature: Signature) -> usize {
        let key = GroupKey { object: self.object, group: self.group, material: self.material, signature };
        let groups = &mut self.out.groups;
        let number = *self.group_numbers.entry(key).or_insert_with(|| {
            groups.push((key, Smoothing::One(self.smoothing)));
            groups.len() - 1
        });
        let smoothing = &mut groups[number].1;
        if *smoothing != Smoothing::One(self.smoothing) && *smoothing != Smoothing::Mixed {
            *smoothing = Smoothing::Mixed;
            // Where there are normals, they say more than smoothing groups.
            if signature & HAS_NORMAL == 0 {
                let line = self.scan.line();
                self.note(&notice::SMOOTHING_GROUPS, line);
            }
        }
        self.current_groups[usize::from(signature)] = Some(number);
        number
    }

    /// The rest of the line as the number of a name.
    fn name(&mut self) -> u32 {
        self.current_groups = [None; 4];
        let line = self.scan.line();
        let bytes = self.scan.rest_of_line();
        let name = String::from_utf8_lossy(&bytes);
        if matches!(name, std::borrow::Cow::Owned(_)) {
            self.note(&notice::NAME_NOT_UTF8, line);
        }
        // Control characters are no part of a name; the writer could not keep them.
        let name = name.replace(|c: char| c.is_ascii_control(), " ");
        self.intern(name.trim_matches(' ').to_owned())
    }

    fn intern(&mut self, name: String) -> u32 {
        if let Some(&number) = self.name_numbers.get(&name) {
            return number;
        }
        // Fewer names than bytes in the file, of which there are at most 2^32 in practice.
        let number = u32::try_from(self.out.names.len()).unwrap_or(0);
        self.out.names.push(name.clone());
        self.name_numbers.insert(name, number);
        number
    }

    /// `mtllib a.mtl b.mtl`.
    fn material_library(&mut self) {
        for name in split_library_names(&self.scan.rest_of_line()) {
            if self.known_libraries.insert(name.clone()) {
                self.out.material_libraries.push(name);
            }
        }
    }
}

/// The material libraries that the text of an OBJ file names, without reading anything else.
pub(super) fn library_names(bytes: &[u8]) -> Vec<String> {
    let lines = bytes.split(|byte| matches!(byte, b'\n' | b'\r')).map(<[u8]>::trim_ascii_start);
    let lists = lines.filter_map(|line| line.strip_prefix(b"mtllib"));
    lists.filter(|list| list.first().is_some_and(u8::is_ascii_whitespace)).flat_map(split_library_names).collect()
}

/// Several names, which may contain blanks, so a name ends with `.mtl`.
fn split_library_names(bytes: &[u8]) -> Vec<String> {
    let text = String::from_utf8_lossy(bytes);
    let mut rest = text.trim_ascii();
    let mut names = Vec::new();
    while !rest.is_empty() {
        let end = end_of_library_name(rest);
        let name = rest[..end].replace(|c: char| c.is_ascii_control(), " ");
        let name = name.trim_matches(' ').to_owned();
        if !name.is_empty() {
            names.push(name);
        }
        rest = rest[end..].trim_ascii_start();
    }
    names
}

/// Where the first name of a list of `.mtl` files ends: after `.mtl` and before a blank.
fn end_of_library_name(names: &str) -> usize {
    let bytes = names.as_bytes();
    let is_end =
        |&at: &usize| bytes[at].is_ascii_whitespace() && at >= 4 && bytes[at - 4..at].eq_ignore_ascii_case(b".mtl");
    (0..bytes.len()).find(is_end).unwrap_or(bytes.len())
}
