//! Planes beside the beauty: one file and one line in `planes!` each.
//!
//! A plane's file says what it takes from a [sample](super::Sample), how the samples of a pixel become one value, and
//! the names of its channels. The command line's names and help, what a render records, the order of the channels in a
//! file, and the memory that a film needs follow. A plane of something that no path records yet needs a field of
//! [`CameraRay`](super::CameraRay) or `Sample` too, which `trace::stages::record` then fills.

mod definition;

pub use self::definition::{Average, Definition, Needs};

// `rustfmt src/film/plane/*.rs` formats the modules: cargo finds none that a macro declares.
macro_rules! planes {
    ($($name:ident: $module:ident,)*) => {
        $(mod $module;)*

        /// Planes that can be asked for beside the beauty; one that nobody asked for is never computed.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Aov {
            $(
                #[doc = concat!("The plane `", stringify!($module), "`.")]
                $name,
            )*
        }

        impl Aov {
            /// All, in the order in which an image keeps them.
            pub const ALL: &[Self] = &[$(Self::$name),*];

            /// Name on the command line.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$name => stringify!($module),)*
                }
            }

            pub(crate) const fn definition(self) -> &'static Definition {
                match self {
                    $(Self::$name => &$module::PLANE,)*
                }
            }
        }
    };
}

planes! {
    Depth: depth,
    Normal: normal,
    Albedo: albedo,
    Position: position,
    Entity: entity,
    Variance: variance,
    Steps: steps,
    Fate: fate,
    Side: side,
}

impl Aov {
    /// Meaning, in one line.
    pub const fn about(self) -> &'static str {
        self.definition().about
    }

    /// Names of the channels that hold this plane in an EXR, in the order in which the image keeps them.
    pub const fn channels(self) -> &'static [&'static str] {
        self.definition().channels
    }

    /// The plane of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|plane| plane.name() == name)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::definition::Value;
    use super::*;
    use crate::film::image::BEAUTY;

    #[test]
    fn no_two_planes_share_a_channel_name() {
        let names: Vec<&str> =
            BEAUTY.iter().chain(Aov::ALL.iter().flat_map(|aov| aov.channels())).copied().collect();
        assert_eq!(names.len(), names.iter().collect::<BTreeSet<_>>().len());
    }

    #[test]
    fn every_plane_names_a_channel_for_each_of_its_values_after_itself() {
        for plane in Aov::ALL {
            let values = match plane.definition().value {
                Value::Number(_) => 1,
                Value::Vector(_) => 3,
            };
            assert_eq!(plane.channels().len(), values, "{}", plane.name());
            let prefix = format!("{}.", plane.name());
            assert!(plane.channels().iter().all(|channel| channel.starts_with(&prefix)), "{}", plane.name());
            assert_eq!(Aov::named(plane.name()), Some(*plane));
        }
    }
}
