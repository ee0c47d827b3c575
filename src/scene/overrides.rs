//! `--set path.to.key=value`: edits of the scene file's text before it is deserialised.

use std::path::Path;

use toml_edit::{ArrayOfTables, DocumentMut, InlineTable, Item, Table, TableLike, Value};

use super::error::{Fault, SceneError, SourceText, suggestion};

/// Complaint about an override: problem and remedy.
type Complaint = (String, String);

/// Text of the scene with the overrides applied; the rest keeps its lines.
pub(super) fn edited(path: &Path, text: String, overrides: &[String]) -> Result<String, SceneError> {
    if overrides.is_empty() {
        return Ok(text);
    }
    let source = SourceText { path, text: &text, on_disk: Some(&text) };
    let mut document = document(&text).map_err(|fault| source.locate(fault))?;
    for text in overrides {
        apply(&mut document, text)?;
    }
    Ok(document.to_string())
}

/// Parses the text as a document that can be edited.
fn document(text: &str) -> Result<DocumentMut, Fault> {
    text.parse::<DocumentMut>().map_err(|error| {
        Fault::maybe_at(error.span(), error.message(), "correct the TOML syntax at the caret")
    })
}

/// Applies one override to the document.
///
/// Array entries are named by index or by their `name`; tables that the file does not have are made.
fn apply(document: &mut DocumentMut, text: &str) -> Result<(), SceneError> {
    let complain = |(problem, help)| SceneError::Override { text: text.to_owned(), problem, help };
    let assignment = || {
        let (path, value) = text.split_once('=')?;
        let keys: Vec<&str> = path.trim().split('.').map(str::trim).collect();
        (!keys.iter().any(|key| key.is_empty())).then_some((keys, value.trim()))
    };
    let (keys, value) = assignment().ok_or_else(|| {
        complain((
            "not of the form path.to.key=value".to_owned(),
            "write for instance --set spacetime.schwarzschild_radius=2".to_owned(),
        ))
    })?;
    let value = parse_value(value).map_err(complain)?;
    assign(document.as_table_mut(), &keys, value).map_err(complain)
}

/// A TOML value, or else a string.
fn parse_value(text: &str) -> Result<Value, Complaint> {
    let looks_like_toml = text.starts_with(['[', '{', '"', '\'']);
    match text.parse::<Value>() {
        Ok(value) => Ok(value),
        Err(error) if looks_like_toml => Err((
            format!("`{text}` is not a TOML value: {}", error.message()),
            "close all brackets and quotes, and quote the whole option in the shell".to_owned(),
        )),
        Err(_) => Ok(Value::from(text)),
    }
}

/// Follows `keys` from the root and puts `value` there.
fn assign(root: &mut Table, keys: &[&str], value: Value) -> Result<(), Complaint> {
    let Some((last, path)) = keys.split_last() else {
        return Ok(());
    };
    let mut table: &mut dyn TableLike = root;
    let mut rest = path.iter();
    let mut at_root = true;
    while let Some(key) = rest.next() {
        // Inside an entry of an array a new table must be inline, or it would be written after the whole array.
        let new = if at_root { Item::Table(Table::new()) } else { Item::Value(InlineTable::new().into()) };
        at_root = false;
        table = match table.entry(key).or_insert(new) {
            Item::ArrayOfTables(array) => match rest.next() {
                Some(which) => choose(array, key, which)?,
                None => return Err(is_a_table(last, keys)),
            },
            item => item.as_table_like_mut().ok_or_else(|| {
                let help = format!("set the whole of `{key}`");
                (format!("leads nowhere: `{key}` is a value without keys"), help)
            })?,
        };
    }
    let occupied = table.get(last).is_some_and(|old| old.is_table() || old.is_array_of_tables());
    if occupied {
        return Err(is_a_table(last, keys));
    }
    table.insert(last, Item::Value(value));
    Ok(())
}

fn is_a_table(key: &str, keys: &[&str]) -> Complaint {
    let help = format!("set one of its keys: {}.key=value", keys.join("."));
    (format!("leads nowhere: `{key}` is a table, not a value"), help)
}

/// The entry of `array` with the index or the name `which`.
fn choose<'a>(array: &'a mut ArrayOfTables, key: &str, which: &str) -> Result<&'a mut Table, Complaint> {
    let count = array.len();
    let names: Vec<String> = array
        .iter()
        .map(|entry| entry.get("name").and_then(Item::as_str).unwrap_or_default().to_owned())
        .collect();
    let index = match which.parse::<usize>() {
        Ok(index) => index,
        Err(_) => {
            let mut found = names.iter().enumerate().filter(|(_, name)| *name == which);
            match (found.next(), found.next()) {
                (Some((index, _)), None) => index,
                (Some(_), Some(_)) => {
                    let help = format!("use the index, {key}.0 to {key}.{}", count - 1);
                    return Err((format!("several entries of `{key}` are named `{which}`"), help));
                }
                (None, _) => {
                    let help = suggestion(which, names.iter().map(String::as_str))
                        .unwrap_or_else(|| format!("use a name from the file, or {key}.0, {key}.1, ..."));
                    return Err((format!("leads nowhere: no entry of `{key}` is named `{which}`"), help));
                }
            }
        }
    };
    array.get_mut(index).ok_or_else(|| {
        let help = "entries count from 0".to_owned();
        (format!("leads nowhere: `{key}` has {count} entries, so there is no {index}"), help)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "[camera] # the eye\nposition = [0, 0, 1]\n\n[[entity]]\nname = \"a\"\nsphere = { radius = 1 }\n\n[[entity]]\nname = \"b\"\n";

    fn edited(text: &str) -> Result<String, SceneError> {
        let mut edited = document(SCENE).unwrap();
        apply(&mut edited, text)?;
        Ok(edited.to_string())
    }

    #[test]
    fn values_are_replaced_in_place_and_comments_stay() {
        assert_eq!(edited("camera.position=[1,2,3]").unwrap(), SCENE.replace("[0, 0, 1]", "[1,2,3]"));
        assert_eq!(
            edited("entity.0.sphere.radius = 2")
                .unwrap()
                .parse::<DocumentMut>()
                .unwrap()["entity"][0]["sphere"]["radius"]
                .as_integer(),
            Some(2)
        );
    }

    #[test]
    fn missing_tables_are_made_in_the_right_entry() {
        let text = edited("entity.a.transform.translate=[1,0,0]").unwrap();
        let document: DocumentMut = text.parse().unwrap();
        assert!(document["entity"][0].get("transform").is_some(), "{text}");
        assert!(document["entity"][1].get("transform").is_none(), "{text}");
        let document: DocumentMut = edited("spacetime.kind=flat").unwrap().parse().unwrap();
        assert_eq!(document["spacetime"]["kind"].as_str(), Some("flat"));
    }

    #[test]
    fn overrides_that_lead_nowhere_name_themselves() {
        for (text, expected) in [
            ("camera", "not of the form"),
            ("=1", "not of the form"),
            ("camera..x=1", "not of the form"),
            ("camera.position.x=1", "`position` is a value without keys"),
            ("entity.7.name=x", "`entity` has 2 entries"),
            ("entity.c.name=x", "no entry of `entity` is named `c`"),
            ("entity.a=1", "--set entity.a=1: leads nowhere: `a` is a table"),
            ("camera=1", "`camera` is a table"),
            ("camera.position=[1,2", "is not a TOML value"),
        ] {
            let message = edited(text).unwrap_err().to_string();
            assert!(message.contains(expected), "{text}: {message}");
        }
    }
}
