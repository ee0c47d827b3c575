//! Statements that name a picture, with their options.

use glam::DVec2;

use crate::shade::Wrap;

/// A statement that names a picture.
pub struct MapStatement<'a> {
    /// Name of the file.
    pub name: &'a str,
    /// Factors on texture coordinates (`-s`), and what is added to them (`-o`).
    pub scale: DVec2,
    pub offset: DVec2,
    /// Wrapping (`-clamp`).
    pub wrap: Wrap,
    /// Factor on the height of bumps (`-bm`).
    pub bumps: f64,
    /// An option that changes the picture's values or their place, and is not followed.
    pub ignored: Option<&'a str>,
}

impl<'a> MapStatement<'a> {
    pub fn of(map: &'a str) -> Self {
        let (scale, offset, wrap) = (DVec2::ONE, DVec2::ZERO, Wrap::Repeat);
        let mut statement = Self { name: map.trim(), scale, offset, wrap, bumps: 1.0, ignored: None };
        while let Some((option, after)) = statement.name.split_once(char::is_whitespace) {
            let most = match option {
                "-o" | "-s" | "-t" => 3,
                "-mm" => 2,
                "-blendu" | "-blendv" | "-cc" | "-clamp" | "-imfchan" | "-texres" | "-bm" | "-boost"
                | "-type" => 1,
                _ => break,
            };
            statement.name = after.trim_start();
            for taken in 0..most {
                let Some((value, after)) = statement.name.split_once(char::is_whitespace) else { break };
                let number = value.parse::<f64>().ok();
                if taken > 0 && number.is_none() {
                    break;
                }
                statement.name = after.trim_start();
                statement.take(option, taken, value, number);
            }
        }
        statement
    }

    /// True if another statement places its picture in the same way.
    pub fn is_placed_as(&self, other: &Self) -> bool {
        (self.scale, self.offset, self.wrap) == (other.scale, other.offset, other.wrap)
    }

    /// Takes a value of an option.
    fn take(&mut self, option: &'a str, place: usize, value: &str, number: Option<f64>) {
        match (option, number.filter(|number| place < 2 && number.is_finite())) {
            ("-s", Some(number)) => self.scale[place] = number,
            ("-o", Some(number)) => self.offset[place] = number,
            ("-bm", Some(number)) => self.bumps = number,
            ("-clamp", _) if value == "on" => self.wrap = Wrap::Clamp,
            ("-cc", _) if value != "on" => {}
            ("-mm" | "-t" | "-imfchan" | "-cc" | "-boost" | "-texres", _) => self.ignored = Some(option),
            _ => {}
        }
    }
}
