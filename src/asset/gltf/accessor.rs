//! Typed columns out of buffers: any component type, strided, sparse, every range checked, nothing read that is not
//! asked for.

use std::collections::HashMap;

use gltf::accessor::sparse::IndexType;
use gltf::accessor::{DataType, Dimensions};

use super::buffers::Buffers;
use crate::asset::flaw::Flaw;

/// Most elements of a column that is read whole but has no buffer view behind it, whose count the file's size therefore
/// does not bound.
const MAX_IMPLICIT: usize = 1 << 16;
/// Zeros that stand for the elements of a column without buffer view; no element is longer.
const ZEROS: [u8; 64] = [0; 64];

/// A column of elements in the bytes of a file.
pub(super) struct Column<'a> {
    index: usize,
    count: usize,
    kind: DataType,
    normalized: bool,
    size: usize,
    /// Bytes of the elements and the distance between two; all zero without.
    dense: Option<(&'a [u8], usize)>,
    /// Elements that replace those, by index.
    sparse: HashMap<u32, &'a [u8]>,
}

impl<'a> Column<'a> {
    /// A column of vectors of these dimensions.
    pub fn of_vectors(
        accessor: &gltf::Accessor,
        dimensions: &[Dimensions],
        buffers: &'a Buffers,
    ) -> Result<Self, Flaw> {
        if !dimensions.contains(&accessor.dimensions()) {
            let names: Vec<_> =
                dimensions.iter().map(|vector| format!("{}-vectors", vector.multiplicity())).collect();
            return Err(damaged(accessor.index(), &format!("does not hold {}", names.join(" or "))));
        }
        Self::open(accessor, buffers)
    }

    /// A column of vertex indices.
    pub fn of_indices(accessor: &gltf::Accessor, buffers: &'a Buffers) -> Result<Self, Flaw> {
        let unsigned = matches!(accessor.data_type(), DataType::U8 | DataType::U16 | DataType::U32);
        if accessor.dimensions() != Dimensions::Scalar || !unsigned {
            return Err(damaged(accessor.index(), "does not hold indices"));
        }
        Self::open(accessor, buffers)
    }

    /// A column of 4 × 4 matrices.
    pub fn of_matrices(accessor: &gltf::Accessor, buffers: &'a Buffers) -> Result<Self, Flaw> {
        if accessor.dimensions() != Dimensions::Mat4 || accessor.data_type() != DataType::F32 {
            return Err(damaged(accessor.index(), "does not hold matrices"));
        }
        Self::open(accessor, buffers)
    }

    fn open(accessor: &gltf::Accessor, buffers: &'a Buffers) -> Result<Self, Flaw> {
        let (index, count, size) = (accessor.index(), accessor.count(), accessor.size());
        let dense = match accessor.view() {
            Some(view) => {
                let stride = view.stride().filter(|stride| *stride > 0).unwrap_or(size);
                let bytes = strided(buffers.view(&view)?, accessor.offset(), stride, size, count)
                    .ok_or_else(|| damaged(index, "reaches beyond its buffer view"))?;
                Some((bytes, stride))
            }
            None => None,
        };
        let mut column = Self {
            index,
            count,
            kind: accessor.data_type(),
            normalized: accessor.normalized(),
            size,
            dense,
            sparse: HashMap::new(),
        };
        if let Some(sparse) = accessor.sparse() {
            column.replace(&sparse, buffers)?;
        }
        Ok(column)
    }

    fn replace(&mut self, sparse: &gltf::accessor::sparse::Sparse, buffers: &'a Buffers) -> Result<(), Flaw> {
        let index_size = match sparse.indices().index_type() {
            IndexType::U8 => 1,
            IndexType::U16 => 2,
            IndexType::U32 => 4,
        };
        let (count, size) = (sparse.count(), self.size);
        let indices = buffers.view(&sparse.indices().view())?;
        let values = buffers.view(&sparse.values().view())?;
        let indices = strided(indices, sparse.indices().offset(), index_size, index_size, count);
        let values = strided(values, sparse.values().offset(), size, size, count);
        let (Some(indices), Some(values)) = (indices, values) else {
            return Err(damaged(self.index, "has sparse values beyond their buffer view"));
        };
        for (index, value) in indices.chunks_exact(index_size).zip(values.chunks_exact(size)).take(count) {
            let index = unsigned_integer(index);
            if index as usize >= self.count {
                return Err(damaged(self.index, "has a sparse index out of range"));
            }
            self.sparse.insert(index, value);
        }
        Ok(())
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Number of elements of a column that is read whole.
    pub fn len_in_full(&self) -> Result<u32, Flaw> {
        let bounded = self.dense.is_some() || self.count <= MAX_IMPLICIT;
        let count = u32::try_from(self.count).ok().filter(|_| bounded);
        count.ok_or_else(|| damaged(self.index, "has too many elements"))
    }

    /// A vector, zero if there is none; integers become floats, normalised where the accessor says so. Components that
    /// the column lacks are 1.
    pub fn vector<const N: usize>(&self, index: u32) -> [f32; N] {
        let bytes = self.element(index);
        let size = self.kind.size();
        std::array::from_fn(|axis| match bytes.get(axis * size..).and_then(|bytes| bytes.get(..size)) {
            Some(bytes) => component(bytes, self.kind, self.normalized),
            None => 1.0,
        })
    }

    /// A matrix by its columns.
    pub fn matrix(&self, index: u32) -> [[f32; 4]; 4] {
        let values = self.vector::<16>(index);
        std::array::from_fn(|column| std::array::from_fn(|row| values[4 * column + row]))
    }

    /// All vertex indices.
    pub fn indices(&self) -> Result<Vec<u32>, Flaw> {
        Ok((0..self.len_in_full()?).map(|index| unsigned_integer(self.element(index))).collect())
    }

    fn element(&self, index: u32) -> &[u8] {
        let replaced = if self.sparse.is_empty() { None } else { self.sparse.get(&index).copied() };
        let dense = || {
            let (bytes, stride) = self.dense?;
            bytes.get(index as usize * stride..)?.get(..self.size)
        };
        replaced.or_else(dense).unwrap_or(ZEROS.get(..self.size).unwrap_or_default())
    }
}

/// The bytes of `count` elements of `size` bytes, `stride` apart; `None` if the last one does not fit.
fn strided(bytes: &[u8], offset: usize, stride: usize, size: usize, count: usize) -> Option<&[u8]> {
    let Some(last) = count.checked_sub(1) else {
        return Some(&[]);
    };
    let end = last.checked_mul(stride)?.checked_add(offset)?.checked_add(size)?;
    bytes.get(offset..end)
}

/// Little-endian unsigned integer of up to 4 bytes.
fn unsigned_integer(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |value, byte| value << 8 | u32::from(*byte))
}

/// One component as a float (glTF 2.0 §3.6.2.2 for the normalised ones).
fn component(bytes: &[u8], kind: DataType, normalized: bool) -> f32 {
    let bits = unsigned_integer(bytes);
    let (value, largest) = match kind {
        DataType::I8 => (f32::from(bits as u8 as i8), f32::from(i8::MAX)),
        DataType::U8 => (f32::from(bits as u8), f32::from(u8::MAX)),
        DataType::I16 => (f32::from(bits as u16 as i16), f32::from(i16::MAX)),
        DataType::U16 => (f32::from(bits as u16), f32::from(u16::MAX)),
        DataType::U32 => (bits as f32, 1.0),
        DataType::F32 => (f32::from_bits(bits), 1.0),
    };
    if normalized { (value / largest).max(-1.0) } else { value }
}

fn damaged(accessor: usize, what: &str) -> Flaw {
    Flaw::new(format!("accessor {accessor} {what}"), "the file is damaged; export it again")
}
