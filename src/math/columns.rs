//! Structure-of-arrays storage: one declaration per column set.
//!
//! `columns!` turns a plain struct into columns. Every routine is generated from the same list of fields, so that no
//! column can be forgotten. Columns are cut into blocks of [`LANES`] lanes: a block of a field fills whole cache lines
//! and vector registers, a row stays within a few neighbouring lines, and one bounds check serves all its fields.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Lanes of a block: a cache line of f64.
pub const LANES: usize = 8;
/// Lanes of two blocks taken as one: a cache line of f32.
pub const PAIRED: usize = 2 * LANES;

/// A field type that knows how blocks of it are stored; vectors are stored by component.
pub trait Field: Copy + Default {
    /// `N` lanes.
    type Block<const N: usize>: Copy;
    /// `N` lanes of defaults.
    fn block<const N: usize>() -> Self::Block<N>;
    /// Value of a lane below `N`.
    fn get<const N: usize>(block: &Self::Block<N>, lane: usize) -> Self;
    /// Overwrites a lane below `N`.
    fn set<const N: usize>(block: &mut Self::Block<N>, lane: usize, value: Self);
    /// Two blocks as one.
    fn join(blocks: [&Self::Block<LANES>; 2]) -> Self::Block<PAIRED>;
    /// The two blocks again.
    fn part(pair: &Self::Block<PAIRED>) -> [Self::Block<LANES>; 2];
}

/// Makes types into fields that are stored whole.
macro_rules! plain_field {
    ($($type:ty),*) => {$(
        impl $crate::math::columns::Field for $type {
            type Block<const N: usize> = [$type; N];
            #[inline(always)]
            fn block<const N: usize>() -> [$type; N] {
                [<$type>::default(); N]
            }
            #[inline(always)]
            fn get<const N: usize>(block: &[$type; N], lane: usize) -> Self {
                block[lane % N]
            }
            #[inline(always)]
            fn set<const N: usize>(block: &mut [$type; N], lane: usize, value: Self) {
                block[lane % N] = value;
            }
            #[inline(always)]
            fn join(
                blocks: [&[$type; $crate::math::columns::LANES]; 2],
            ) -> [$type; $crate::math::columns::PAIRED] {
                let mut pair = Self::block();
                for (half, block) in pair.as_chunks_mut().0.iter_mut().zip(blocks) {
                    *half = *block;
                }
                pair
            }
            #[inline(always)]
            fn part(
                pair: &[$type; $crate::math::columns::PAIRED],
            ) -> [[$type; $crate::math::columns::LANES]; 2] {
                let halves = pair.as_chunks().0;
                [halves[0], halves[1]]
            }
        }
    )*};
}
pub(crate) use plain_field;
plain_field!(f64, f32, u32, bool);

macro_rules! vector_field {
    ($($vector:ident of $scalar:ty),*) => {$(
        impl Field for $vector {
            type Block<const N: usize> = [[$scalar; N]; 3];
            #[inline(always)]
            fn block<const N: usize>() -> [[$scalar; N]; 3] {
                [<$scalar>::block(); 3]
            }
            #[inline(always)]
            fn get<const N: usize>([x, y, z]: &[[$scalar; N]; 3], lane: usize) -> Self {
                $vector::new(x[lane % N], y[lane % N], z[lane % N])
            }
            #[inline(always)]
            fn set<const N: usize>([x, y, z]: &mut [[$scalar; N]; 3], lane: usize, value: Self) {
                x[lane % N] = value.x;
                y[lane % N] = value.y;
                z[lane % N] = value.z;
            }
            #[inline(always)]
            fn join([a, b]: [&[[$scalar; LANES]; 3]; 2]) -> [[$scalar; PAIRED]; 3] {
                let join = |i: usize| <$scalar>::join([&a[i], &b[i]]);
                [join(0), join(1), join(2)]
            }
            #[inline(always)]
            fn part([x, y, z]: &[[$scalar; PAIRED]; 3]) -> [[[$scalar; LANES]; 3]; 2] {
                let ([xa, xb], [ya, yb], [za, zb]) = (<$scalar>::part(x), <$scalar>::part(y), <$scalar>::part(z));
                [[xa, ya, za], [xb, yb, zb]]
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

/// Two rows as one.
impl<A: Row, B: Row> Row for (A, B) {
    type Block = (A::Block, B::Block);

    #[inline(always)]
    fn get((a, b): &Self::Block, lane: usize) -> Self {
        (A::get(a, lane), B::get(b, lane))
    }

    #[inline(always)]
    fn set((a, b): &mut Self::Block, lane: usize, row: Self) {
        A::set(a, lane, row.0);
        B::set(b, lane, row.1);
    }
}

/// Nothing, for kernels that need no second input.
impl Row for () {
    type Block = ();

    #[inline(always)]
    fn get((): &(), _: usize) -> Self {}

    #[inline(always)]
    fn set((): &mut (), _: usize, (): Self) {}
}

/// A row type of which two blocks can be taken as one.
pub trait Paired: Row {
    /// The fields of [`PAIRED`] lanes.
    type Pair: Copy + Default;
    /// Two blocks as one.
    fn join(blocks: [&Self::Block; 2]) -> Self::Pair;
    /// The two blocks again.
    fn part(pair: &Self::Pair) -> [Self::Block; 2];
    /// Row of a lane below [`PAIRED`].
    fn get_paired(pair: &Self::Pair, lane: usize) -> Self;
    /// Overwrites a lane below [`PAIRED`].
    fn set_paired(pair: &mut Self::Pair, lane: usize, row: Self);
}

impl Paired for () {
    type Pair = ();

    #[inline(always)]
    fn join(_: [&(); 2]) {}

    #[inline(always)]
    fn part((): &()) -> [(); 2] {
        [(), ()]
    }

    #[inline(always)]
    fn get_paired((): &(), _: usize) -> Self {}

    #[inline(always)]
    fn set_paired((): &mut (), _: usize, (): Self) {}
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

    /// Grows to hold at least `lanes` lanes.
    #[inline(always)]
    pub fn grow(&mut self, lanes: usize) {
        if self.blocks.len() * LANES < lanes {
            self.resize(lanes);
        }
    }

    /// Takes `lanes` rows from elsewhere.
    pub fn gather(&mut self, lanes: usize, row: impl Fn(usize) -> R) {
        self.resize(lanes);
        (0..lanes).for_each(|lane| self.set(lane, row(lane)));
    }

    /// Makes `blocks` blocks of rows on all threads.
    pub fn fill(blocks: usize, row: impl Fn(usize) -> R + Sync) -> Self {
        let block = |number: usize| {
            let mut block = R::Block::default();
            (0..LANES).for_each(|lane| R::set(&mut block, lane, row(number * LANES + lane)));
            block
        };
        Self { blocks: (0..blocks).into_par_iter().map(block).collect() }
    }

    /// A block.
    #[inline(always)]
    pub fn block(&self, number: usize) -> &R::Block {
        &self.blocks[number]
    }

    /// Heap memory, bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&self.blocks[..])
    }

    /// True if there are no lanes.
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

    /// Those of the first `lanes` lanes whose rows are so: quick where few are.
    pub fn lanes_where(
        &self,
        lanes: usize,
        is_so: impl Fn(&R) -> bool + Copy,
    ) -> impl Iterator<Item = usize> {
        let in_block = move |block: &R::Block, lane| is_so(&R::get(block, lane));
        // All lanes of a block, so that they are looked at side by side.
        let any = move |block: &R::Block| (0..LANES).fold(false, |any, lane| any | in_block(block, lane));
        (self.blocks(lanes).iter().enumerate()).filter(move |(_, block)| any(block)).flat_map(
            move |(number, block)| {
                let first = number * LANES;
                (0..LANES.min(lanes - first))
                    .filter(move |&lane| in_block(block, lane))
                    .map(move |i| first + i)
            },
        )
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

        #[doc = concat!("A block of columns of [`", stringify!($row), "`], of `N` lanes.")]
        #[derive(Clone, Copy)]
        pub struct $block<
            $($real: $crate::math::columns::Field,)?
            const N: usize = { $crate::math::columns::LANES },
        > {
            $($field: <$type as $crate::math::columns::Field>::Block<N>,)*
        }

        impl<$($real: $crate::math::columns::Field,)? const N: usize> Default for $block<$($real,)? N> {
            #[inline(always)]
            fn default() -> Self {
                use $crate::math::columns::Field;
                Self { $($field: <$type as Field>::block(),)* }
            }
        }

        impl<$($real: $crate::math::columns::Field,)? const N: usize> $block<$($real,)? N> {
            #[inline(always)]
            fn row(&self, lane: usize) -> $row $(<$real>)? {
                use $crate::math::columns::Field;
                $row { $($field: <$type as Field>::get(&self.$field, lane),)* }
            }

            #[inline(always)]
            fn put(&mut self, lane: usize, row: $row $(<$real>)?) {
                use $crate::math::columns::Field;
                let $row { $($field,)* } = row;
                $(<$type as Field>::set(&mut self.$field, lane, $field);)*
            }
        }

        impl $(<$real: $crate::math::columns::Field<Block<{ $crate::math::columns::LANES }>: Send>>)?
            $crate::math::columns::Row for $row $(<$real>)?
        {
            type Block = $block $(<$real>)?;

            #[inline(always)]
            fn get(block: &Self::Block, lane: usize) -> Self {
                block.row(lane)
            }

            #[inline(always)]
            fn set(block: &mut Self::Block, lane: usize, row: Self) {
                block.put(lane, row);
            }
        }

        impl $(<$real: $crate::math::columns::Field<Block<{ $crate::math::columns::LANES }>: Send>>)?
            $crate::math::columns::Paired for $row $(<$real>)?
        {
            type Pair = $block<$($real,)? { $crate::math::columns::PAIRED }>;

            #[inline(always)]
            fn join([a, b]: [&Self::Block; 2]) -> Self::Pair {
                use $crate::math::columns::Field;
                $block { $($field: <$type as Field>::join([&a.$field, &b.$field]),)* }
            }

            #[inline(always)]
            fn part(pair: &Self::Pair) -> [Self::Block; 2] {
                use $crate::math::columns::Field;
                $(let $field = <$type as Field>::part(&pair.$field);)*
                [$block { $($field: $field[0],)* }, $block { $($field: $field[1],)* }]
            }

            #[inline(always)]
            fn get_paired(pair: &Self::Pair, lane: usize) -> Self {
                pair.row(lane)
            }

            #[inline(always)]
            fn set_paired(pair: &mut Self::Pair, lane: usize, row: Self) {
                pair.put(lane, row);
            }
        }
    };
}
pub(crate) use columns;
