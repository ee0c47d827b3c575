//! Damage that knows the structure of files: bytes, attributes of OpenEXR, chunks of PNG and GLB, JSON, words of text.

use serde_json::Value;

use crate::support::dice::Dice;

/// Whole numbers at which sizes, counts, indices and enumerations go wrong.
const WHOLE: [i64; 26] = [
    0,
    1,
    2,
    3,
    4,
    7,
    255,
    256,
    32_767,
    32_768,
    65_535,
    65_536,
    16_777_216,
    2_147_483_647,
    2_147_483_648,
    4_294_967_294,
    4_294_967_295,
    4_294_967_296,
    1 << 53,
    i64::MAX,
    -1,
    -2,
    -2_147_483_648,
    5121,
    5123,
    5126,
];

/// Fractions at which geometry, colours and lengths go wrong.
const FRACTIONS: [f64; 16] = [
    -0.0,
    0.5,
    -1.0,
    1e-45,
    1e-320,
    1e-20,
    1e-7,
    1.000_000_1,
    1e7,
    1e18,
    1e20,
    3.4e38,
    3.5e38,
    1e200,
    1e308,
    -1e308,
];

/// Words that some readers take for numbers, and some for nothing.
const WORDS: [&str; 16] = [
    "nan",
    "-nan",
    "inf",
    "-1.#IND",
    "1e999",
    "-0",
    "0x10",
    "1,5",
    "1e",
    "99999999999999999999",
    "\u{feff}",
    "é",
    "..",
    "/",
    "[[",
    "\\",
];

/// Damages bytes, half of the time near the start.
pub fn bytes(dice: &mut Dice, data: &mut Vec<u8>, other: &[u8]) {
    for _ in 0..=dice.below(4) {
        let near = if dice.chance(0.5) { data.len().min(400) } else { data.len() };
        let at = dice.below(near);
        let most = 1 << dice.below(9);
        let length = (1 + dice.below(most)).min(data.len() - at.min(data.len()));
        match dice.below(9) {
            _ if data.is_empty() => data.push(dice.byte()),
            0 => data[at] ^= 1 << dice.below(8),
            1 => data[at] = dice.byte(),
            2 => data[at] = dice.pick(&[0, 1, 0x7f, 0x80, 0xff]),
            3 => number(dice, data, at),
            4 => data.truncate(at),
            5 => drop(data.drain(at..at + length)),
            6 => {
                let again = data[at..at + length].to_vec();
                data.splice(at..at, again);
            }
            7 => {
                let from = dice.below(other.len());
                let piece = other[from..(from + length).min(other.len())].to_vec();
                data.splice(at..at, piece);
            }
            _ => data[at..at + length].fill(dice.pick(&[0, 0xff])),
        }
    }
}

/// Writes an extreme number over `data` at `at`, in either order of bytes.
fn number(dice: &mut Dice, data: &mut [u8], at: usize) {
    let whole = dice.pick(&WHOLE);
    let fraction = dice.pick(&[f64::NAN, f64::INFINITY, 0.0, 1e30, 3.4e38, 1e-45, -1.0, 1e300]);
    let mut new = match dice.below(5) {
        0 => (whole as u16).to_le_bytes().to_vec(),
        1 => (whole as u32).to_le_bytes().to_vec(),
        2 => whole.to_le_bytes().to_vec(),
        3 => (fraction as f32).to_le_bytes().to_vec(),
        _ => fraction.to_le_bytes().to_vec(),
    };
    if dice.chance(0.3) {
        new.reverse();
    }
    let end = data.len().min(at + new.len());
    data[at..end].copy_from_slice(&new[..end - at]);
}

/// Damages the attributes in the header of an OpenEXR file, or its bytes.
pub fn exr(dice: &mut Dice, data: &mut Vec<u8>, other: &[u8]) {
    let Some((mut attributes, rest)) = exr_header(data) else { return bytes(dice, data, other) };
    if attributes.is_empty() || dice.chance(0.4) {
        return bytes(dice, data, other);
    }
    for _ in 0..=dice.below(2) {
        let at = dice.below(attributes.len());
        match dice.below(8) {
            _ if attributes.is_empty() => {}
            0 => drop(attributes.remove(at)),
            1 => attributes.push(attributes[at].clone()),
            2 => attributes[at].0 = attributes[dice.below(attributes.len())].0.clone(),
            3 => attributes[at].1 = attributes[dice.below(attributes.len())].1.clone(),
            4 => {
                let value = attributes[dice.below(attributes.len())].2.clone();
                attributes[at].2 = value;
            }
            _ => {
                let value = &mut attributes[at].2;
                let place = dice.below(value.len()) & !3;
                if dice.chance(0.7) { number(dice, value, place) } else { bytes(dice, value, other) }
            }
        }
    }
    let mut new = data[..8].to_vec();
    for (name, kind, value) in attributes {
        new.extend([&name[..], &[0], &kind, &[0], &(value.len() as u32).to_le_bytes(), &value].concat());
    }
    new.push(0);
    new.extend(&data[rest..]);
    *data = new;
}

/// Name, type and value of an attribute.
type Attribute = (Vec<u8>, Vec<u8>, Vec<u8>);

/// The attributes of the first header, and where what follows them starts.
fn exr_header(data: &[u8]) -> Option<(Vec<Attribute>, usize)> {
    let text = |at: usize| {
        let length = data.get(at..)?.iter().position(|&byte| byte == 0)?;
        Some((data[at..at + length].to_vec(), at + length + 1))
    };
    let (mut attributes, mut at) = (Vec::new(), 8);
    loop {
        let (name, after) = text(at)?;
        if name.is_empty() {
            return Some((attributes, after));
        }
        let (kind, after) = text(after)?;
        let size = u32::from_le_bytes(data.get(after..after + 4)?.try_into().ok()?) as usize;
        attributes.push((name, kind, data.get(after + 4..after + 4 + size)?.to_vec()));
        at = after + 4 + size;
    }
}

/// Damages chunks of a PNG and corrects their check sums, or its bytes.
pub fn png(dice: &mut Dice, data: &mut Vec<u8>, other: &[u8]) {
    let Some(mut chunks) = png_chunks(data) else { return bytes(dice, data, other) };
    if chunks.is_empty() || dice.chance(0.2) {
        return bytes(dice, data, other);
    }
    for _ in 0..=dice.below(2) {
        let at = if dice.chance(0.5) { 0 } else { dice.below(chunks.len()) };
        let strange =
            dice.pick(&[*b"PLTE", *b"tRNS", *b"acTL", *b"fcTL", *b"fdAT", *b"iCCP", *b"gAMA", *b"eXIf"]);
        match dice.below(7) {
            _ if chunks.is_empty() => {}
            0 => drop(chunks.remove(at)),
            1 => chunks.insert(at, chunks[at].clone()),
            2 => chunks.insert(dice.below(chunks.len()), (strange, vec![dice.byte(); dice.below(40)])),
            3 if chunks[at].1.len() > 12 => {
                // Bit depth, colour type, compression, filter, interlacing.
                let field = 8 + dice.below(5);
                chunks[at].1[field] = dice.pick(&[0, 1, 2, 3, 4, 6, 8, 16]);
            }
            4 if chunks[at].1.len() > 12 => {
                let place = 4 * dice.below(2);
                let side = [1u32, 2, 7, 9, 40, 4_000, 100_000, 1 << 30, u32::MAX];
                chunks[at].1[place..place + 4].copy_from_slice(&dice.pick(&side).to_be_bytes());
            }
            _ => bytes(dice, &mut chunks[at].1, other),
        }
    }
    let mut new = data[..8].to_vec();
    for (kind, value) in chunks {
        let body = [&kind[..], &value].concat();
        new.extend((value.len() as u32).to_be_bytes());
        new.extend(&body);
        new.extend(crc(&body).to_be_bytes());
    }
    *data = new;
}

fn png_chunks(data: &[u8]) -> Option<Vec<([u8; 4], Vec<u8>)>> {
    let (mut chunks, mut at) = (Vec::new(), 8);
    while at < data.len() {
        let length = u32::from_be_bytes(data.get(at..at + 4)?.try_into().ok()?) as usize;
        chunks
            .push((data.get(at + 4..at + 8)?.try_into().ok()?, data.get(at + 8..at + 8 + length)?.to_vec()));
        at += 12 + length;
    }
    Some(chunks)
}

/// The check sum of PNG chunks (ISO 3309).
fn crc(data: &[u8]) -> u32 {
    let step = |crc: u32| if crc & 1 == 1 { 0xedb8_8320 ^ (crc >> 1) } else { crc >> 1 };
    !data.iter().fold(!0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), |crc, _| step(crc)))
}

/// Damages nodes of a JSON document, or its words.
pub fn json(dice: &mut Dice, data: &mut Vec<u8>, others: &[&[u8]]) {
    let Ok(mut root) = serde_json::from_slice::<Value>(data) else { return text(dice, data, others) };
    if dice.chance(0.15) {
        return text(dice, data, others);
    }
    for _ in 0..=dice.below(3) {
        let mut places = Vec::new();
        visit(&root, String::new(), &mut places);
        let place = places[dice.below(places.len())].clone();
        let donor = root.pointer(&places[dice.below(places.len())]).cloned().unwrap_or(Value::Null);
        if dice.chance(0.3) {
            remove(&mut root, &place);
        } else if let Some(node) = root.pointer_mut(&place) {
            damage(dice, node, donor);
        }
    }
    *data = root.to_string().into_bytes();
}

fn visit(node: &Value, place: String, places: &mut Vec<String>) {
    match node {
        Value::Object(map) => {
            map.iter().for_each(|(key, child)| visit(child, format!("{place}/{key}"), places))
        }
        Value::Array(items) => {
            items
                .iter()
                .enumerate()
                .for_each(|(index, child)| visit(child, format!("{place}/{index}"), places));
        }
        _ => {}
    }
    places.push(place);
}

fn remove(root: &mut Value, place: &str) {
    let Some((parent, key)) = place.rsplit_once('/') else { return };
    match root.pointer_mut(parent) {
        Some(Value::Object(map)) => drop(map.remove(key)),
        Some(Value::Array(items)) => drop(key.parse().map(|index: usize| items.remove(index))),
        _ => {}
    }
}

fn damage(dice: &mut Dice, node: &mut Value, donor: Value) {
    let wrong =
        [Value::Null, Value::from(""), Value::from(true), Value::Array(vec![]), serde_json::json!({})];
    match node {
        _ if dice.chance(0.1) => *node = donor,
        _ if dice.chance(0.1) => *node = wrong[dice.below(wrong.len())].clone(),
        Value::Number(_) if dice.chance(0.3) => *node = Value::from(dice.below(12)),
        Value::Number(_) if dice.chance(0.5) => *node = Value::from(dice.pick(&FRACTIONS)),
        Value::Number(_) => *node = Value::from(dice.pick(&WHOLE)),
        Value::String(text) => {
            *text = if dice.chance(0.5) {
                format!("{text}{}", dice.pick(&WORDS))
            } else {
                dice.pick(&WORDS).to_string()
            }
        }
        Value::Array(items) if !items.is_empty() => {
            let (from, to) = (dice.below(items.len()), dice.below(items.len()));
            match dice.below(3) {
                0 => items.push(items[from].clone()),
                1 => items.swap(from, to),
                _ => items.truncate(from),
            }
        }
        other => *other = donor,
    }
}

/// Damages the JSON or the binary part of a GLB file, or its bytes.
pub fn glb(dice: &mut Dice, data: &mut Vec<u8>, others: &[&[u8]]) {
    let parts = || {
        let length = u32::from_le_bytes(data.get(12..16)?.try_into().ok()?) as usize;
        Some((data.get(20..20 + length)?.to_vec(), data.get(28 + length..).unwrap_or_default().to_vec()))
    };
    let Some((mut head, mut body)) = parts().filter(|_| !dice.chance(0.1)) else {
        return bytes(dice, data, others[0]);
    };
    if body.is_empty() || dice.chance(0.7) {
        json(dice, &mut head, others)
    } else {
        bytes(dice, &mut body, &[])
    }
    *data = glb_of(head, body);
}

/// A GLB file of its two parts.
pub fn glb_of(mut head: Vec<u8>, mut body: Vec<u8>) -> Vec<u8> {
    head.resize(head.len().next_multiple_of(4), b' ');
    body.resize(body.len().next_multiple_of(4), 0);
    let size = |length: usize| (length as u32).to_le_bytes();
    let whole = size(28 + head.len() + body.len());
    let start = [&b"glTF\x02\0\0\0"[..], &whole, &size(head.len()), b"JSON", &head].concat();
    [&start[..], &size(body.len()), b"BIN\0", &body].concat()
}

/// Damages lines and words of a text, or its bytes and their encoding.
pub fn text(dice: &mut Dice, data: &mut Vec<u8>, others: &[&[u8]]) {
    let other = dice.pick(others);
    if dice.chance(0.1) {
        return bytes(dice, data, other);
    }
    let mut text = String::from_utf8_lossy(data).into_owned();
    for _ in 0..=dice.below(4) {
        text = if dice.chance(0.35) { lines(dice, &text, other) } else { words(dice, &text, other) };
    }
    *data = match dice.below(20) {
        0 => text.replace('\n', "\r").into_bytes(),
        1 => text.replace('\n', "\r\n").into_bytes(),
        2 => format!("\u{feff}{text}").into_bytes(),
        3 => text.encode_utf16().flat_map(u16::to_le_bytes).collect(),
        4 => text.replacen('\n', " \\\n", 3).into_bytes(),
        _ => text.into_bytes(),
    };
}

fn lines(dice: &mut Dice, text: &str, other: &[u8]) -> String {
    let mut lines: Vec<&str> = text.split('\n').collect();
    let (from, to) = (dice.below(lines.len()), dice.below(lines.len()));
    let other = String::from_utf8_lossy(other);
    let strange: Vec<&str> = other.split('\n').collect();
    match dice.below(6) {
        0 => drop(lines.remove(from)),
        1 => lines.insert(to, lines[from]),
        2 => lines.swap(from, to),
        3 => lines.truncate(from),
        4 => lines.insert(to, strange[dice.below(strange.len())]),
        _ => return [&lines[..from].join("\n"), "\n", &lines[from..].concat()].concat(),
    }
    lines.join("\n")
}

/// A text as words, numbers among them, and what is between them.
fn split(text: &str) -> Vec<&str> {
    let is_word = |c: char| c.is_alphanumeric() || "_.+-".contains(c);
    let mut pieces = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let end = rest.find(|c| is_word(c) != is_word(first)).unwrap_or(rest.len());
        let (piece, after) = rest.split_at(end);
        pieces.push(piece);
        rest = after;
    }
    pieces
}

fn words(dice: &mut Dice, text: &str, other: &[u8]) -> String {
    let mut pieces = split(text);
    if pieces.is_empty() {
        return dice.pick(&WORDS).to_string();
    }
    let at = dice.below(pieces.len());
    let extreme =
        if dice.chance(0.5) { dice.pick(&WHOLE).to_string() } else { format!("{:e}", dice.pick(&FRACTIONS)) };
    let other = String::from_utf8_lossy(other);
    let strange = split(&other);
    let is_number = pieces[at].parse::<f64>().is_ok();
    match dice.below(6) {
        0 | 1 if is_number => pieces[at] = &extreme,
        2 => pieces[at] = dice.pick(&WORDS),
        3 => drop(pieces.remove(at)),
        4 if !strange.is_empty() => pieces[at] = dice.pick(&strange),
        5 => pieces.insert(at, pieces[at]),
        _ => pieces[at] = dice.pick(&pieces.clone()),
    }
    pieces.concat()
}
