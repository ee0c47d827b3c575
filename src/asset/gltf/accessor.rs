//! Typed columns out of buffers: any component type, strided, sparse, every range checked.

use gltf::accessor::{DataType, Dimensions};

use super::buffers::Buffers;
use crate::asset::error::Flaw;

/// Most elements of an accessor that has no buffer view behind it, whose count the file's size therefore does not
/// bound.
const MAX_IMPLICIT: usize = 1 << 24;

/// Reads a column of 3-vectors; integers become floats, normalised where the accessor says so.
pub(super) fn read_vectors(accessor: &gltf::Accessor, buffers: &Buffers) -> Result<Vec<[f32; 3]>, Flaw> {
    if accessor.dimensions() != Dimensions::Vec3 {
        return Err(damaged(accessor, "does not hold 3-vectors"));
    }
    let (kind, normalized) = (accessor.data_type(), accessor.normalized());
    let size = kind.size();
    read(accessor, buffers, |bytes| {
        [0, 1, 2].map(|axis| component(bytes.get(axis * size..).unwrap_or(&[]), kind, normalized))
    })
}

/// Reads a column of vertex indices.
pub(super) fn read_indices(accessor: &gltf::Accessor, buffers: &Buffers) -> Result<Vec<u32>, Flaw> {
    let kind = accessor.data_type();
    let unsigned = matches!(kind, DataType::U8 | DataType::U16 | DataType::U32);
    if accessor.dimensions() != Dimensions::Scalar || !unsigned {
        return Err(damaged(accessor, "does not hold indices"));
    }
    read(accessor, buffers, |bytes| unsigned_integer(bytes, kind.size()))
}

/// Reads the elements, then lays the sparse ones over them.
fn read<T: Copy>(
    accessor: &gltf::Accessor,
    buffers: &Buffers,
    decode: impl Fn(&[u8]) -> T,
) -> Result<Vec<T>, Flaw> {
    let (count, size) = (accessor.count(), accessor.size());
    let mut values = match accessor.view() {
        Some(view) => {
            let bytes = buffers.view(&view)?;
            let stride = view.stride().filter(|stride| *stride > 0).unwrap_or(size);
            let elements = strided(bytes, accessor.offset(), stride, size, count)
                .ok_or_else(|| damaged(accessor, "reaches beyond its buffer view"))?;
            let mut values = Vec::with_capacity(count);
            values.extend(elements.map(&decode));
            values
        }
        None if count <= MAX_IMPLICIT => vec![decode(&vec![0; size]); count],
        None => return Err(damaged(accessor, "has too many elements")),
    };
    let Some(sparse) = accessor.sparse() else {
        return Ok(values);
    };
    let index_size = match sparse.indices().index_type() {
        gltf::accessor::sparse::IndexType::U8 => 1,
        gltf::accessor::sparse::IndexType::U16 => 2,
        gltf::accessor::sparse::IndexType::U32 => 4,
    };
    let index_bytes = buffers.view(&sparse.indices().view())?;
    let value_bytes = buffers.view(&sparse.values().view())?;
    let indices = strided(index_bytes, sparse.indices().offset(), index_size, index_size, sparse.count());
    let replacements = strided(value_bytes, sparse.values().offset(), size, size, sparse.count());
    let (Some(indices), Some(replacements)) = (indices, replacements) else {
        return Err(damaged(accessor, "has sparse values beyond their buffer view"));
    };
    for (index, replacement) in indices.zip(replacements) {
        let index = unsigned_integer(index, index_size) as usize;
        let value =
            values.get_mut(index).ok_or_else(|| damaged(accessor, "has a sparse index out of range"))?;
        *value = decode(replacement);
    }
    Ok(values)
}

/// `count` elements of `size` bytes, `stride` apart; `None` if the last one does not fit.
fn strided(
    bytes: &[u8],
    offset: usize,
    stride: usize,
    size: usize,
    count: usize,
) -> Option<impl Iterator<Item = &[u8]>> {
    let last = count.saturating_sub(1).checked_mul(stride)?.checked_add(offset)?;
    let fits = count == 0 || last.checked_add(size)? <= bytes.len();
    fits.then(|| (0..count).filter_map(move |i| bytes.get(offset + i * stride..)?.get(..size)))
}

/// Little-endian unsigned integer of up to 4 bytes.
fn unsigned_integer(bytes: &[u8], size: usize) -> u32 {
    bytes.iter().take(size).rev().fold(0, |value, byte| value << 8 | u32::from(*byte))
}

/// One component as a float (glTF 2.0 §3.6.2.2 for the normalised ones).
fn component(bytes: &[u8], kind: DataType, normalized: bool) -> f32 {
    let bits = unsigned_integer(bytes, kind.size());
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

fn damaged(accessor: &gltf::Accessor, what: &str) -> Flaw {
    Flaw::new(format!("accessor {} {what}", accessor.index()), "the file is damaged; export it again")
}
