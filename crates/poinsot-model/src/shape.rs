//! Checks a parsed file against the schema: unknown keys, missing keys, wrong types and words, numbers that are not
//! finite. Invalid parts are dropped, so that one fault does not hide others.

use crate::check_sensor::key_fits;
use crate::document::KeyPath;
use crate::finding::{Findings, Key};
use crate::suggest;
use poinsot_files::excerpt;
use serde_json::Value as Schema;
use toml::Spanned;
use toml::de::{DeTable, DeValue};
use toml::{Table, Value};

/// Larger numbers are meaningless in SI for a spacecraft, and their squares overflow.
pub(crate) const LARGEST: f64 = 1e30;

/// Checks the whole file; returns the valid part.
pub(crate) fn check_shape(root: &Schema, findings: &mut Findings<'_, '_>) -> Table {
    let document = findings.document;
    let mut shape = Shape { root, findings };
    let top = Key {
        path: KeyPath::default(),
        subject: String::new(),
    };
    shape.table(root, &document.table, &top, 0)
}

struct Shape<'s, 'f, 'd, 'i> {
    root: &'s Schema,
    findings: &'f mut Findings<'d, 'i>,
}

impl<'s> Shape<'s, '_, '_, '_> {
    /// The schema, or the one it refers to.
    fn resolve(&self, schema: &'s Schema) -> &'s Schema {
        schema
            .get("$ref")
            .and_then(Schema::as_str)
            .and_then(|path| self.root.pointer(path.trim_start_matches('#')))
            .unwrap_or(schema)
    }

    /// The alternatives of a value, flattened.
    fn alternatives(&self, schema: &'s Schema, found: &mut Vec<&'s Schema>, depth: usize) {
        let schema = self.resolve(schema);
        let inner = schema.get("anyOf").or_else(|| schema.get("oneOf"));
        match inner.and_then(Schema::as_array) {
            Some(items) if depth < 8 => {
                for item in items {
                    self.alternatives(item, found, depth + 1);
                }
            }
            _ => found.push(schema),
        }
    }

    fn table(&mut self, schema: &'s Schema, table: &DeTable<'_>, key: &Key, byte: usize) -> Table {
        let known = schema.get("properties").and_then(Schema::as_object);
        let free = schema
            .get("additionalProperties")
            .filter(|free| free.is_object());
        let mut clean = Table::new();
        let mut replaced: Vec<&str> = Vec::new();
        for (name, value) in table {
            let property = known.and_then(|known| known.get(name.get_ref().as_ref()));
            let here = Key {
                path: key.path.key(name.get_ref()),
                subject: key.subject.clone(),
            };
            match property.or(free) {
                Some(property) => {
                    if let Some(value) = self.value(property, value, &here) {
                        clean.insert(name.get_ref().to_string(), value);
                    }
                }
                None => {
                    let word = table.get("type").and_then(|t| t.get_ref().as_str());
                    let names: Vec<&str> = known
                        .into_iter()
                        .flat_map(|known| known.keys().map(String::as_str))
                        .filter(|key| word.is_none_or(|word| key_fits(word, key)))
                        .collect();
                    let (code, problem, remedy) = suggest::unknown_key(name.get_ref(), &names);
                    replaced.extend(suggest::meant(name.get_ref(), &names));
                    let value = self.findings.document.excerpt(value);
                    self.findings
                        .push(code, &here, name.span().start, value, problem, remedy);
                }
            }
        }
        let required = schema.get("required").and_then(Schema::as_array);
        for name in required.into_iter().flatten().filter_map(Schema::as_str) {
            // A key with another spelling has been reported already.
            if !table.contains_key(name) && !replaced.contains(&name) {
                let about = known
                    .and_then(|known| known.get(name))
                    .and_then(|property| property.get("description"))
                    .and_then(Schema::as_str)
                    .and_then(|text| text.split(['.', ';']).next())
                    .unwrap_or("see `poinsot schema`");
                let here = Key {
                    path: key.path.key(name),
                    subject: key.subject.clone(),
                };
                self.findings.push(
                    if name == "schema" { "E0103" } else { "E0106" },
                    &here,
                    byte,
                    String::new(),
                    "the key is missing".to_owned(),
                    if name == "schema" {
                        "write schema = \"poinsot.model/1\"".to_owned()
                    } else {
                        format!("add {name}: {about}")
                    },
                );
            }
        }
        clean
    }

    fn value(
        &mut self,
        schema: &'s Schema,
        value: &Spanned<DeValue<'_>>,
        key: &Key,
    ) -> Option<Value> {
        let mut alternatives = Vec::new();
        self.alternatives(schema, &mut alternatives, 0);
        match value.get_ref() {
            DeValue::String(text) => self.string(&alternatives, text, value, key),
            DeValue::Integer(integer) => {
                let number = i64::from_str_radix(integer.as_str(), integer.radix())
                    .map(|n| n as f64)
                    .or_else(|_| integer.as_str().parse());
                self.number(&alternatives, number.unwrap_or(f64::NAN), value, key)
            }
            DeValue::Float(float) => {
                let number = float.as_str().parse().unwrap_or(f64::NAN);
                self.number(&alternatives, number, value, key)
            }
            DeValue::Boolean(flag) => {
                if accepts(&alternatives, "boolean").is_some() {
                    return Some(Value::Boolean(*flag));
                }
                self.wrong_type(&alternatives, value, key)
            }
            DeValue::Array(items) => self.array(&alternatives, items, value, key),
            DeValue::Table(table) => match accepts(&alternatives, "object") {
                Some(inner) => Some(Value::Table(self.table(
                    inner,
                    table,
                    key,
                    value.span().start,
                ))),
                None => self.wrong_type(&alternatives, value, key),
            },
            DeValue::Datetime(_) => self.wrong_type(&alternatives, value, key),
        }
    }

    fn array(
        &mut self,
        alternatives: &[&'s Schema],
        items: &[Spanned<DeValue<'_>>],
        value: &Spanned<DeValue<'_>>,
        key: &Key,
    ) -> Option<Value> {
        // Numbers or rows of numbers: the first element decides.
        let first = items.first();
        let nested = first.is_some_and(|first| first.get_ref().is_array());
        let lists = alternatives.iter().copied();
        let lists = lists.filter(|a| type_of(a) == Some("array"));
        let chosen = lists.min_by_key(|a| {
            let inner = a.get("items").map(|items| self.resolve(items));
            (inner.and_then(type_of) == Some("array")) != nested
        });
        let Some(chosen) = chosen else {
            return self.wrong_type(alternatives, value, key);
        };
        let bound = |name: &str| chosen.get(name).and_then(Schema::as_u64);
        let length = items.len() as u64;
        if bound("minItems").is_some_and(|n| length < n)
            || bound("maxItems").is_some_and(|n| length > n)
        {
            self.findings.refuse(
                "E0107",
                key,
                format!("the list has {length} entries"),
                format!("write {}", self.expected(&[chosen])),
            );
            return None;
        }
        let inner = chosen.get("items")?;
        let mut clean = Vec::with_capacity(items.len());
        let mut whole = true;
        for (index, item) in items.iter().enumerate() {
            let mut here = key.index(index);
            if let Some(table) = item.get_ref().as_table() {
                here.subject = subject_of(&key.path, table);
            }
            match self.value(inner, item, &here) {
                Some(item) => clean.push(item),
                None => whole = false,
            }
        }
        whole.then_some(Value::Array(clean))
    }

    fn string(
        &mut self,
        alternatives: &[&'s Schema],
        text: &str,
        value: &Spanned<DeValue<'_>>,
        key: &Key,
    ) -> Option<Value> {
        if accepts(alternatives, "string").is_none() {
            return self.wrong_type(alternatives, value, key);
        }
        let words = words(alternatives);
        let free = alternatives
            .iter()
            .any(|a| type_of(a) == Some("string") && words_of(a).is_empty());
        if free || words.contains(&text) {
            return Some(Value::String(text.to_owned()));
        }
        let nearest = match suggest::nearest(text, &words) {
            Some(word) => format!("; did you mean \"{word}\"?"),
            None => String::new(),
        };
        self.findings.refuse(
            "E0107",
            key,
            "the word is not one of those allowed here".to_owned(),
            format!("write {}{nearest}", self.expected(alternatives)),
        );
        None
    }

    fn number(
        &mut self,
        alternatives: &[&'s Schema],
        number: f64,
        value: &Spanned<DeValue<'_>>,
        key: &Key,
    ) -> Option<Value> {
        if accepts(alternatives, "number").is_none() {
            return self.wrong_type(alternatives, value, key);
        }
        if !number.is_finite() {
            self.findings.refuse(
                "E0108",
                key,
                "the number is not finite".to_owned(),
                "write a finite number",
            );
            return None;
        }
        if number.abs() > LARGEST {
            self.findings.refuse(
                "E0108",
                key,
                "the number is larger than 1e30".to_owned(),
                "check its unit: all quantities are SI",
            );
            return None;
        }
        Some(Value::Float(number))
    }

    fn wrong_type(
        &mut self,
        alternatives: &[&'s Schema],
        value: &Spanned<DeValue<'_>>,
        key: &Key,
    ) -> Option<Value> {
        let found = match value.get_ref() {
            DeValue::String(_) => "text",
            DeValue::Integer(_) | DeValue::Float(_) => "a number",
            DeValue::Boolean(_) => "true or false",
            DeValue::Datetime(_) => "a date",
            DeValue::Array(_) => "a list",
            DeValue::Table(_) => "a table",
        };
        let sections = alternatives.iter().any(|a| {
            type_of(a) == Some("array")
                && a.get("items")
                    .is_some_and(|items| type_of(self.resolve(items)) == Some("object"))
        });
        let name = key.path.to_string();
        let remedy = if sections && value.get_ref().is_table() {
            format!("write [[{name}]] with two brackets: there may be several")
        } else {
            format!("write {}", self.expected(alternatives))
        };
        self.findings.refuse(
            "E0107",
            key,
            format!("{found} is here, but another type is needed"),
            remedy,
        );
        None
    }

    /// Expected values, as text.
    fn expected(&self, alternatives: &[&'s Schema]) -> String {
        let mut texts: Vec<String> = Vec::new();
        let words = words(alternatives);
        if !words.is_empty() {
            let quoted: Vec<String> = words.iter().map(|w| format!("\"{w}\"")).collect();
            texts.push(quoted.join(", "));
        }
        for alternative in alternatives {
            let text = match type_of(alternative) {
                Some("string") if words_of(alternative).is_empty() => "text in quotes".to_owned(),
                Some("number") => "a number".to_owned(),
                Some("boolean") => "true, false".to_owned(),
                Some("array") => self.expected_list(alternative),
                Some("object") => match alternative.get("properties").and_then(Schema::as_object) {
                    Some(known) if known.contains_key("sigma") => {
                        "a table { sigma_<unit> = x }".to_owned()
                    }
                    Some(known) => {
                        let keys: Vec<&str> = known.keys().map(String::as_str).collect();
                        format!("a table with {}", keys.join(", "))
                    }
                    None => "a table".to_owned(),
                },
                _ => continue,
            };
            texts.push(text);
        }
        texts.join(" or ")
    }

    fn expected_list(&self, list: &'s Schema) -> String {
        let count = match list.get("minItems").and_then(Schema::as_u64) {
            Some(n) => format!("{n} "),
            None => String::new(),
        };
        let inner = list.get("items").map(|items| self.resolve(items));
        match inner.and_then(type_of) {
            Some("number") => format!("a list of {count}numbers"),
            Some("array") => format!("a list of {count}rows of 3 numbers"),
            Some("object") => "sections with two brackets".to_owned(),
            _ => {
                let mut alternatives = Vec::new();
                if let Some(inner) = inner {
                    self.alternatives(inner, &mut alternatives, 0);
                }
                match words(&alternatives) {
                    words if words.is_empty() => format!("a list of {count}texts in quotes"),
                    words => {
                        let quoted: Vec<String> =
                            words.iter().map(|w| format!("\"{w}\"")).collect();
                        format!("a list of {}", quoted.join(", "))
                    }
                }
            }
        }
    }
}

/// Name of an entry in a list of tables.
fn subject_of(list: &KeyPath, table: &DeTable<'_>) -> String {
    match table.get("name").and_then(|name| name.get_ref().as_str()) {
        Some(name) => format!("{list} \"{}\"", excerpt(name, 60)),
        None => String::new(),
    }
}

fn type_of(schema: &Schema) -> Option<&str> {
    match schema.get("type").and_then(Schema::as_str) {
        Some("integer") => Some("number"),
        None if schema.get("const").is_some() || schema.get("enum").is_some() => Some("string"),
        other => other,
    }
}

fn accepts<'s>(alternatives: &[&'s Schema], name: &str) -> Option<&'s Schema> {
    alternatives
        .iter()
        .copied()
        .find(|schema| type_of(schema) == Some(name))
}

fn words_of(schema: &Schema) -> Vec<&str> {
    if let Some(word) = schema.get("const").and_then(Schema::as_str) {
        return vec![word];
    }
    let list = schema.get("enum").and_then(Schema::as_array);
    list.into_iter()
        .flatten()
        .filter_map(Schema::as_str)
        .collect()
}

fn words<'s>(alternatives: &[&'s Schema]) -> Vec<&'s str> {
    alternatives.iter().flat_map(|a| words_of(a)).collect()
}
