//! Numbers of vertices and normals.

use crate::asset::flaw::Flaw;
use crate::text;

/// Refuses a coordinate of a vertex that is no finite number.
pub(super) fn check_coordinate(word: &str) -> Result<(), Flaw> {
    let shown = text::quoted(word);
    match word.parse::<f32>() {
        Ok(number) if number.is_finite() => Ok(()),
        Ok(_) => Err(Flaw::new(
            format!("the vertex is not finite: `{shown}`"),
            "fix the vertex in the modelling program and export again",
        )),
        Err(_) => Err(Flaw::new(
            format!("`{shown}` is not a number"),
            "write the coordinates as decimal numbers, such as -1.5",
        )),
    }
}

/// True if four numbers are a place and a weight by which it can be divided.
pub(super) fn has_usable_weight(words: &[&str]) -> bool {
    let numbers: Option<Vec<f32>> = words.iter().map(|word| word.parse().ok()).collect();
    let Some([place @ .., weight]) = numbers.as_deref().filter(|numbers| numbers.len() == 4) else {
        return false;
    };
    weight.is_finite() && place.iter().all(|coordinate| (coordinate / weight).is_finite())
}

/// Finite numbers at the beginning of a text.
pub(super) fn finite_numbers<const N: usize>(values: &str) -> Option<[f32; N]> {
    let mut words = values.split_whitespace();
    let mut numbers = [0.0; N];
    for number in &mut numbers {
        *number = words.next()?.parse().ok().filter(|number: &f32| number.is_finite())?;
    }
    Some(numbers)
}
