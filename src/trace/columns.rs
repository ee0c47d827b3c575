//! Structure-of-arrays storage: one declaration per column set.
//!
//! `columns!` turns a plain struct into a set of parallel columns. Every routine is generated from the same list of
//! fields, so that no column can be forgotten.

use glam::{DVec3, Vec3};

use crate::geometry::PrimitiveId;
use crate::shade::Media;

/// Storage of one field for many lanes; vectors are stored by component.
pub trait Column<T> {
    /// Value of a lane.
    fn get(&self, lane: usize) -> T;
    /// Overwrites a lane.
    fn set(&mut self, lane: usize, value: T);
    /// Grows or shrinks to `lanes`, new lanes hold `fill`.
    fn resize(&mut self, lanes: usize, fill: T);
}

/// A field type that knows its storage.
pub trait Field: Copy + Default {
    /// Its column.
    type Storage: Column<Self> + Default;
}

macro_rules! plain_field {
    ($($type:ty),*) => {$(
        impl Field for $type {
            type Storage = Vec<$type>;
        }
        impl Column<$type> for Vec<$type> {
            #[inline(always)]
            fn get(&self, lane: usize) -> $type {
                self[lane]
            }
            #[inline(always)]
            fn set(&mut self, lane: usize, value: $type) {
                self[lane] = value;
            }
            fn resize(&mut self, lanes: usize, fill: $type) {
                self.resize(lanes, fill);
            }
        }
    )*};
}
plain_field!(f64, f32, u32, bool, PrimitiveId, Media);

macro_rules! vector_field {
    ($($vector:ident of $scalar:ty),*) => {$(
        impl Field for $vector {
            type Storage = [Vec<$scalar>; 3];
        }
        impl Column<$vector> for [Vec<$scalar>; 3] {
            #[inline(always)]
            fn get(&self, lane: usize) -> $vector {
                $vector::new(self[0][lane], self[1][lane], self[2][lane])
            }
            #[inline(always)]
            fn set(&mut self, lane: usize, value: $vector) {
                self[0][lane] = value.x;
                self[1][lane] = value.y;
                self[2][lane] = value.z;
            }
            fn resize(&mut self, lanes: usize, fill: $vector) {
                self[0].resize(lanes, fill.x);
                self[1].resize(lanes, fill.y);
                self[2].resize(lanes, fill.z);
            }
        }
    )*};
}
vector_field!(DVec3 of f64, Vec3 of f32);

/// A set of parallel columns that stores one row per lane.
pub trait Columns: Default {
    /// A lane's row.
    type Row: Copy + Default;
    /// Row of a lane.
    fn get(&self, lane: usize) -> Self::Row;
    /// Overwrites a lane's row.
    fn set(&mut self, lane: usize, row: Self::Row);
    /// Grows or shrinks to `lanes`.
    fn resize(&mut self, lanes: usize);
}

/// Declares a row struct and its columns.
macro_rules! columns {
    (
        $(#[$row_doc:meta])* pub struct $row:ident => $columns:ident {
            $($(#[$doc:meta])* $field:ident: $type:ty,)*
        }
    ) => {
        $(#[$row_doc])*
        #[derive(Clone, Copy, Debug, Default)]
        pub struct $row {
            $($(#[$doc])* pub $field: $type,)*
        }

        #[doc = concat!("Columns of [`", stringify!($row), "`].")]
        #[derive(Default)]
        pub struct $columns {
            $($field: <$type as $crate::trace::columns::Field>::Storage,)*
        }

        impl $crate::trace::columns::Columns for $columns {
            type Row = $row;

            #[inline(always)]
            fn get(&self, lane: usize) -> $row {
                use $crate::trace::columns::Column;
                $row { $($field: self.$field.get(lane),)* }
            }

            #[inline(always)]
            fn set(&mut self, lane: usize, row: $row) {
                use $crate::trace::columns::Column;
                let $row { $($field,)* } = row;
                $(self.$field.set(lane, $field);)*
            }

            fn resize(&mut self, lanes: usize) {
                $($crate::trace::columns::Column::resize(&mut self.$field, lanes, <$type>::default());)*
            }
        }
    };
}
pub(crate) use columns;
