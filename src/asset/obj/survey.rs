//! First reading of an OBJ file: what `tobj` does not check, with the lines of whatever is wrong, and all that is not
//! geometry. It computes with any index that it is given, and tells of no statement that it passes over.

use std::io::{self, BufRead};
use std::path::Path;

use super::numbers::{check_coordinate, finite_numbers, has_usable_weight};
use crate::asset::files::Files;
use crate::asset::flaw::Flaw;
use crate::asset::mtl::Libraries;
use crate::asset::notes::Notes;
use crate::asset::statements::{Statement, Statements};
use crate::text;

/// Columns that face corners point into: positions, texture coordinates and normals.
const NAMES: [&str; 3] = ["vertex", "texture coordinate", "normal"];
const POSITION: usize = 0;
const TEXTURE: usize = 1;
const NORMAL: usize = 2;

/// Name of what comes before any object or group, or in one without a name.
const UNNAMED: &str = "unnamed_object";

/// Statements of free-form curves and surfaces.
const FREE_FORM: [&str; 22] = [
    "cstype", "deg", "bmat", "step", "curv", "curv2", "surf", "parm", "trim", "hole", "scrv", "sp", "end",
    "con", "vp", "ctech", "stech", "bsp", "bzp", "cdc", "cdp", "res",
];
/// Statements without which the surface looks the same: smoothing is by normals, the rest is for other programs.
const SILENT: [&str; 8] = ["s", "mg", "bevel", "c_interp", "d_interp", "lod", "shadow_obj", "trace_obj"];

/// Faces of one object and one material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Section {
    /// Line of the statement with which it begins; 0 for the file's beginning.
    pub line: usize,
    /// Index in [`Survey::objects`].
    pub object: usize,
    /// Index of the material in the libraries.
    pub material: Option<usize>,
}

/// Content of a file beside its geometry.
pub(super) struct Survey {
    /// In the order of the file.
    pub sections: Vec<Section>,
    /// Names of objects and groups.
    pub objects: Vec<String>,
    /// The material libraries that the file names.
    pub libraries: Libraries,
    /// Content that was passed over.
    pub notes: Notes,
    /// True if any vertex has more than three numbers.
    pub has_long_vertices: bool,
    /// True if any normal is not made of three finite numbers.
    pub has_odd_normals: bool,
    /// True if texture coordinates are named that the file does not have, so that none are read.
    lacks_textures: bool,
    /// Counts of positions, texture coordinates and normals.
    counts: [i64; 3],
    /// The largest index of each in this section, and its line.
    largest: [(i64, usize); 3],
    /// Corners of faces, and how many of them have a normal.
    corners: usize,
    with_normal: usize,
    /// True if the last section has faces.
    has_faces: bool,
    lines: usize,
    points: usize,
}

impl Survey {
    /// Reads a file to its end; the inner error is what is wrong with it, and where.
    ///
    /// # Errors
    /// Errors of the operating system.
    pub fn of(
        mut statements: Statements<impl BufRead>,
        folder: &Path,
        files: &Files,
    ) -> io::Result<Result<Self, Flaw>> {
        let mut survey = Self {
            sections: vec![Section { line: 0, object: 0, material: None }],
            objects: vec![UNNAMED.to_owned()],
            libraries: Libraries::default(),
            notes: Notes::default(),
            has_long_vertices: false,
            has_odd_normals: false,
            lacks_textures: false,
            counts: [0; 3],
            largest: [(0, 0); 3],
            corners: 0,
            with_normal: 0,
            has_faces: false,
            lines: 0,
            points: 0,
        };
        while let Some(statement) = statements.next()? {
            if let Err(flaw) = survey.statement(&statement, folder, files) {
                return Ok(Err(flaw));
            }
        }
        Ok(survey.finish())
    }

    /// True if there are normals, and corners without one.
    pub fn has_partial_normals(&self) -> bool {
        self.counts[NORMAL] > 0 && self.with_normal < self.corners
    }

    /// True if texture coordinates are read: if a material looks at them, and all that are named are there.
    pub fn reads_textures(&self) -> bool {
        self.libraries.has_textures() && !self.lacks_textures
    }

    fn statement(&mut self, statement: &Statement, folder: &Path, files: &Files) -> Result<(), Flaw> {
        let line = statement.line;
        let here = |flaw: Flaw| flaw.at(format!("line {line}"));
        match statement.keyword {
            "v" => self.vertex(statement).map_err(here)?,
            "vt" => self.counts[TEXTURE] += 1,
            "vn" => self.normal(statement),
            "f" => self.face(statement).map_err(here)?,
            "o" | "g" => {
                self.check_indices("up to the end of their object there are")?;
                let name = if statement.name.is_empty() { UNNAMED } else { statement.name };
                self.objects.push(text::quoted(name).into_owned());
                self.begin(Section { line, object: self.objects.len() - 1, ..self.section() });
            }
            "usemtl" => {
                let material = self.material(statement);
                if material != self.section().material {
                    self.check_indices("up to the next material there are")?;
                    self.begin(Section { line, material, ..self.section() });
                }
            }
            "mtllib" => self.libraries.read(statement.name, folder, files, &mut self.notes),
            "l" => self.lines += 1,
            "p" => self.points += 1,
            keyword if FREE_FORM.contains(&keyword) => {
                self.notes.add("free-form curves and surfaces are left out, in line", line.to_string());
            }
            keyword if SILENT.contains(&keyword) => {}
            keyword => self.notes.add("statements that are not understood are left out", keyword),
        }
        Ok(())
    }

    fn section(&self) -> Section {
        self.sections.last().copied().unwrap_or(Section { line: 0, object: 0, material: None })
    }

    /// Ends the last section, or replaces it if it has no faces.
    fn begin(&mut self, section: Section) {
        if !std::mem::take(&mut self.has_faces) {
            self.sections.pop();
        }
        self.sections.push(section);
    }

    fn material(&mut self, statement: &Statement) -> Option<usize> {
        if statement.name.is_empty() {
            self.notes.add("`usemtl` without a name means grey, in line", statement.line.to_string());
            return None;
        }
        let found = self.libraries.find(statement.name);
        if found.is_none() {
            self.notes.add("materials that no library before them defines are grey", statement.name);
        }
        found
    }

    fn vertex(&mut self, statement: &Statement) -> Result<(), Flaw> {
        self.counts[POSITION] += 1;
        let mut words = statement.values().split_whitespace();
        for axis in 0..3 {
            let word = words.next().ok_or_else(|| {
                Flaw::new(
                    format!("the vertex has {axis} numbers instead of 3"),
                    "the file is damaged or cut off; export it again",
                )
            })?;
            check_coordinate(word)?;
        }
        if words.next().is_some() {
            self.has_long_vertices = true;
            let words: Vec<&str> = statement.values().split_whitespace().take(5).collect();
            if words.len() == 4 && !has_usable_weight(&words) {
                let kind = "weights of vertices by which they cannot be divided are left out, in line";
                self.notes.add(kind, statement.line.to_string());
            }
        }
        Ok(())
    }

    fn normal(&mut self, statement: &Statement) {
        self.counts[NORMAL] += 1;
        if finite_numbers::<3>(statement.values()).is_none() {
            self.has_odd_normals = true;
            let kind = "normals that are not three finite numbers are replaced, in line";
            self.notes.add(kind, statement.line.to_string());
        }
    }

    fn face(&mut self, statement: &Statement) -> Result<(), Flaw> {
        let mut count = 0;
        for corner in statement.values().split_whitespace() {
            self.corner(corner, statement.line)?;
            count += 1;
        }
        if count < 3 {
            let kind = "faces with fewer than three corners are left out, in line";
            self.notes.add(kind, statement.line.to_string());
        }
        self.corners += count;
        self.has_faces = true;
        Ok(())
    }

    /// Checks a face corner `v`, `v/vt`, `v//vn` or `v/vt/vn`, as far as can be known before the end of its section.
    fn corner(&mut self, corner: &str, line: usize) -> Result<(), Flaw> {
        let malformed = || {
            Flaw::new(
                format!("`{}` is not a face corner", text::quoted(corner)),
                "write corners as v, v/vt, v//vn or v/vt/vn",
            )
        };
        for (column, word) in corner.split('/').enumerate() {
            if word.is_empty() && column > 0 {
                continue;
            }
            let index: i64 = word.parse().map_err(|_| malformed())?;
            let before = *self.counts.get(column).ok_or_else(malformed)?;
            if index == 0 || index < -before {
                if column != TEXTURE {
                    return Err(out_of_range(column, index, "before it there are", before));
                }
                self.lost_texture(line);
            }
            self.largest[column] = self.largest[column].max((index, line));
            self.with_normal += usize::from(column == NORMAL);
        }
        Ok(())
    }

    fn lost_texture(&mut self, line: usize) {
        let kind = "without texture coordinates, since some are named that the file does not have, in line";
        self.notes.add(kind, line.to_string());
        self.lacks_textures = true;
    }

    /// Checks the indices of a section at its end, where `tobj` looks them up.
    fn check_indices(&mut self, known: &str) -> Result<(), Flaw> {
        for column in [POSITION, NORMAL] {
            let ((index, line), count) = (self.largest[column], self.counts[column]);
            if index > count {
                return Err(out_of_range(column, index, known, count).at(format!("line {line}")));
            }
        }
        let (index, line) = self.largest[TEXTURE];
        if index > self.counts[TEXTURE] {
            self.lost_texture(line);
        }
        Ok(())
    }

    fn finish(mut self) -> Result<Self, Flaw> {
        self.check_indices("the file has")?;
        if self.lines > 0 {
            self.notes.add("line elements have no surface and are ignored", self.lines.to_string());
        }
        if self.points > 0 {
            self.notes.add("point elements have no surface and are ignored", self.points.to_string());
        }
        Ok(self)
    }
}

fn out_of_range(column: usize, index: i64, known: &str, count: i64) -> Flaw {
    let name = NAMES[column];
    Flaw::new(
        format!("{name} index {index} is out of range: {known} {count}"),
        "indices count from 1, or backwards from -1; the file is damaged or cut off",
    )
}
