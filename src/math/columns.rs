//! Structure-of-arrays storage: one declaration per column set.
//!
//! `columns!` turns a plain struct into columns. Every routine is generated from the same list of fields, so that no
//! column can be forgotten. Columns are cut into blocks of [`LANES`] lanes: a block of a field fills whole cache lines
//! and vector registers, a row stays within a few neighbouring lines, and one bounds check serves all its fields.

use glam::{DVec3, Vec3};

/// Lanes of a block: a cache line of f64.
pub const LANES: usize = 8;

/// A field type that knows how a block of it is stored; vectors are stored by component.
pub trait Field: Copy + Default {
    /// One block.
    type Block: Copy + Default;
    /// Value of a lane below [`LANES`].
    fn get(block: &Self::Block, lane: usize) -> Self;
    /// Overwrites a lane below [`LANES`].
    fn set(block: &mut Self::Block, lane: usize, value: Self);
}

/// Makes types into fields that are stored whole.
macro_rules! plain_field {
    ($($type:ty),*) => {$(
        impl $crate::math::columns::Field for $type {
            type Block = [$type; $crate::math::columns::LANES];
            #[inline(always)]
            fn get(block: &Self::Block, lane: usize) -> Self {
                block[lane % $crate::math::columns::LANES]
            }
            #[inline(always)]
            fn set(block: &mut Self::Block, lane: usize, value: Self) {
                block[lane % $crate::math::columns::LANES] = value;
            }
        }
    )*};
}
pub(crate) use plain_field;
plain_field!(f64, f32, u32, bool);

macro_rules! vector_field {
    ($($vector:ident of $scalar:ty),*) => {$(
        impl Field for $vector {
            type Block = [[$scalar; LANES]; 3];
            #[inline(always)]
            fn get([x, y, z]: &Self::Block, lane: usize) -> Self {
                $vector::new(x[lane % LANES], y[lane % LANES], z[lane % LANES])
            }
            #[inline(always)]
            fn set([x, y, z]: &mut Self::Block, lane: usize, value: Self) {
                x[lane % LANES] = value.x;
                y[lane % LANES] = value.y;
                z[lane % LANES] = value.z;
            }
        }
    )*};
}
vector_field!(DVec3 of f64, Vec3 of f32);

/// A row type: the fields of one lane.
pub trait Row: Copy + Default {
    /// The fields of [`LANES`] lanes.
    type Block: Copy + Default + Send;
    /// Row of a lane below [`LANES`].
    fn get(block: &Self::Block, lane: usize) -> Self;
    /// Overwrites a lane below [`LANES`].
    fn set(block: &mut Self::Block, lane: usize, row: Self);
}

/// Nothing, for kernels that need no second input.
impl Row for () {
    type Block = ();

    #[inline(always)]
    fn get((): &(), _: usize) -> Self {}

    #[inline(always)]
    fn set((): &mut (), _: usize, (): Self) {}
}

/// Rows of many lanes.
pub struct Columns<R: Row> {
    blocks: Vec<R::Block>,
}

impl<R: Row> Default for Columns<R> {
    fn default() -> Self {
        Self { blocks: Vec::new() }
    }
}

impl<R: Row> Columns<R> {
    /// Grows or shrinks to hold `lanes` lanes.
    pub fn resize(&mut self, lanes: usize) {
        self.blocks.resize(lanes.div_ceil(LANES), R::Block::default());
    }

    /// Takes `lanes` rows from elsewhere.
    pub fn gather(&mut self, lanes: usize, row: impl Fn(usize) -> R) {
        self.resize(lanes);
        (0..lanes).for_each(|lane| self.set(lane, row(lane)));
    }

    /// Whether there are no lanes.
    pub fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// Row of a lane.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> R {
        R::get(&self.blocks[lane / LANES], lane % LANES)
    }

    /// Overwrites a lane's row.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, row: R) {
        R::set(&mut self.blocks[lane / LANES], lane % LANES, row);
    }

    /// Blocks that hold the first `lanes` lanes.
    pub fn blocks(&self, lanes: usize) -> &[R::Block] {
        &self.blocks[..lanes.div_ceil(LANES)]
    }

    /// Blocks that hold the first `lanes` lanes.
    pub fn blocks_mut(&mut self, lanes: usize) -> &mut [R::Block] {
        &mut self.blocks[..lanes.div_ceil(LANES)]
    }
}

/// Declares a row struct and its columns; a row may be generic in one type of number.
macro_rules! columns {
    (
        $(#[$row_doc:meta])* pub struct $row:ident $(<$real:ident>)? => $block:ident {
            $($(#[$doc:meta])* $field:ident: $type:ty,)*
        }
    ) => {
        $(#[$row_doc])*
        #[derive(Clone, Copy, Debug, Default)]
        pub struct $row $(<$real>)? {
            $($(#[$doc])* pub $field: $type,)*
        }

        #[doc = concat!("A block of columns of [`", stringify!($row), "`].")]
        #[derive(Clone, Copy, Default)]
        pub struct $block $(<$real: $crate::math::columns::Field>)? {
            $($field: <$type as $crate::math::columns::Field>::Block,)*
        }

        impl $(<$real: $crate::math::columns::Field<Block: Send>>)? $crate::math::columns::Row
            for $row $(<$real>)?
        {
            type Block = $block $(<$real>)?;

            #[inline(always)]
            fn get(block: &Self::Block, lane: usize) -> Self {
                use $crate::math::columns::Field;
                $row { $($field: Field::get(&block.$field, lane),)* }
            }

            #[inline(always)]
            fn set(block: &mut Self::Block, lane: usize, row: Self) {
                use $crate::math::columns::Field;
                let $row { $($field,)* } = row;
                $(Field::set(&mut block.$field, lane, $field);)*
            }
        }
    };
}
pub(crate) use columns;
