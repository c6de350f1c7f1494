//! Checks a parsed file against the table of keys: unknown, missing and misplaced keys, wrong types and words, names, and
//! numbers out of range. Parts that cannot be read are dropped, so that one fault does not hide others.

use crate::check_name::{misspelt, unknown_name};
use crate::document::KeyPath;
use crate::finding::{Findings, Key, subject};
use crate::suggest;
use poinsot_files::{as_read, short};
use serde_json::{Value as Schema, json};
use std::collections::{HashMap, HashSet};
use toml::Spanned;
use toml::de::{DeTable, DeValue};
use toml::{Table, Value};

/// Version of the format.
pub const MODEL_SCHEMA: &str = "poinsot.model/1";

/// Larger numbers are meaningless in SI for a spacecraft, and their squares overflow.
pub(crate) const LARGEST: f64 = 1e30;

/// A bound that no instrument or vehicle comes near.
const TINY: f64 = 1e-9;

/// A format with the codes of its faults.
pub struct Format {
    /// Name and version.
    pub name: &'static str,
    /// A file that is not TOML.
    pub syntax: &'static str,
    /// The format is not stated.
    pub version: &'static str,
    /// An unknown key.
    pub unknown: &'static str,
    /// A key of another unit or form.
    pub unit: &'static str,
    /// A missing key.
    pub missing: &'static str,
    /// A value of a wrong type, or a wrong word.
    pub kind: &'static str,
    /// A number out of range, where no row states another code.
    pub range: &'static str,
    /// A key that does not fit another one, where no row states another code.
    pub unfit: &'static str,
}

impl Format {
    /// One with this code for every fault.
    pub const fn of(name: &'static str, code: &'static str) -> Self {
        Self {
            name,
            syntax: code,
            version: code,
            unknown: code,
            unit: code,
            missing: code,
            kind: code,
            range: code,
            unfit: code,
        }
    }
}

/// The model file.
pub(crate) const MODEL: Format = Format {
    name: MODEL_SCHEMA,
    syntax: "E0102",
    version: "E0103",
    unknown: "E0104",
    unit: "E0105",
    missing: "E0106",
    kind: "E0107",
    range: "E0108",
    unfit: "E0105",
};

/// Checks the whole file; returns the valid part.
pub(crate) fn check_shape(
    format: &'static Format,
    root: &'static Schema,
    findings: &mut Findings<'_>,
) -> Table {
    let document = findings.document;
    let mut shape = Shape {
        format,
        root,
        findings,
        code: format.range,
        word: format.kind,
        names: HashMap::new(),
    };
    shape.table(root, &document.table, &Key::default(), 0, None)
}

struct Shape<'f, 'd> {
    format: &'static Format,
    root: &'static Schema,
    findings: &'f mut Findings<'d>,
    /// Code of a number out of range in the present table.
    code: &'static str,
    /// Code of a wrong word in the present key.
    word: &'static str,
    /// Names in each list of tables that a key refers to.
    names: HashMap<&'static str, HashSet<String>>,
}

/// A table with those around it.
#[derive(Clone, Copy)]
struct Scope<'a> {
    schema: &'static Schema,
    table: &'a DeTable<'a>,
    key: &'a Key,
    outer: Option<&'a Scope<'a>>,
}

impl Scope<'_> {
    /// The row of a key in this table or one around it, with its table.
    fn row(&self, name: &str) -> Option<(&Self, &'static Schema)> {
        let own = rows(self.schema).and_then(|rows| rows.get(name));
        own.map(|row| (self, row)).or_else(|| self.outer?.row(name))
    }
}

impl Shape<'_, '_> {
    /// The schema, or the one it refers to.
    fn resolve(&self, schema: &'static Schema) -> &'static Schema {
        schema
            .get("$ref")
            .and_then(Schema::as_str)
            .and_then(|path| self.root.pointer(path.trim_start_matches('#')))
            .unwrap_or(schema)
    }

    /// The alternatives of a value, flattened.
    fn alternatives(&self, schema: &'static Schema) -> Vec<&'static Schema> {
        let schema = self.resolve(schema);
        let inner = schema.get("anyOf").or_else(|| schema.get("oneOf"));
        match inner.and_then(Schema::as_array) {
            Some(items) => items.iter().flat_map(|i| self.alternatives(i)).collect(),
            None => vec![schema],
        }
    }

    fn table(
        &mut self,
        schema: &'static Schema,
        table: &DeTable<'_>,
        key: &Key,
        byte: usize,
        outer: Option<&Scope<'_>>,
    ) -> Table {
        let scope = &Scope {
            schema,
            table,
            key,
            outer,
        };
        let around = self.code;
        self.code = text_of(schema, "x-code").unwrap_or(around);
        let known = rows(schema);
        let free = schema
            .get("additionalProperties")
            .filter(|free| free.is_object());
        let mut clean = Table::new();
        let mut replaced: Vec<&str> = Vec::new();
        for (name, value) in table {
            if self.findings.is_full() {
                break;
            }
            let here = key.named(name.get_ref());
            let property = known.and_then(|known| known.get(name.get_ref().as_ref()));
            let Some(property) = property.or(free) else {
                let names = self.allowed(scope);
                let (is_unit, problem, remedy) = suggest::unknown_key(name.get_ref(), &names);
                let code = match is_unit {
                    true => self.format.unit,
                    false => self.format.unknown,
                };
                replaced.extend(suggest::meant(name.get_ref(), &names));
                let value = self.findings.document.excerpt(value);
                self.findings
                    .push(code, &here, name.span().start, value, problem, remedy);
                continue;
            };
            let given = !is_none(value.get_ref());
            if given && self.meets(property, "x-only", scope) == Some(false) {
                replaced.extend(self.refuse_unfit(property, name.get_ref(), &here, scope));
                continue;
            }
            self.check_needs(property, &here, scope);
            let own = self.code;
            self.code = text_of(property, "x-code").unwrap_or(own);
            self.word = text_of(property, "x-word-code").unwrap_or(self.format.kind);
            if let Some(value) = self.value(property, value, &here, scope) {
                clean.insert(name.get_ref().to_string(), value);
            }
            self.code = own;
        }
        for (name, property) in known.into_iter().flatten() {
            let with = self.meets(property, "x-required", scope) == Some(true)
                && property.get("x-required").is_some();
            // A key with another spelling has been reported already.
            let there = table.contains_key(name.as_str()) || replaced.contains(&name.as_str());
            if (with || is_required(schema, name)) && !there {
                self.refuse_missing(name, property, key, byte);
            }
        }
        self.code = around;
        clean
    }

    fn refuse_missing(&mut self, name: &str, row: &'static Schema, key: &Key, byte: usize) {
        let about = text_of(row, "description").and_then(|text| text.split(['.', ';']).next());
        let about = about.unwrap_or("see `poinsot schema`");
        let (code, remedy) = match name {
            "schema" => (
                self.format.version,
                format!("write schema = \"{}\"", self.format.name),
            ),
            _ => (self.format.missing, format!("add {name}: {about}")),
        };
        let (key, problem) = (key.named(name), "the key is missing".to_owned());
        self.findings
            .push(code, &key, byte, String::new(), problem, remedy);
    }

    /// Keys of a table that its other keys allow.
    fn allowed(&self, scope: &Scope<'_>) -> Vec<&'static str> {
        let known = rows(scope.schema).into_iter().flatten();
        let fitting = known.filter(|(_, row)| self.meets(row, "x-only", scope) != Some(false));
        fitting.map(|(name, _)| name.as_str()).collect()
    }

    /// Whether another key has one of the values that a row asks for; `None` where that key is itself at fault.
    fn meets(&self, row: &'static Schema, what: &str, scope: &Scope<'_>) -> Option<bool> {
        let Some((name, values)) = condition(row, what) else {
            return Some(true);
        };
        let (scope, row) = scope.row(name)?;
        let value = match scope.table.get(name).map(Spanned::get_ref) {
            None if is_required(scope.schema, name) => return None,
            None => return Some(false),
            Some(DeValue::Boolean(flag)) => json!(flag),
            Some(DeValue::String(word)) => {
                let known = words(&self.alternatives(row)).contains(&word.as_ref());
                known.then(|| json!(word))?
            }
            Some(_) => return None,
        };
        Some(values.contains(&value))
    }

    /// Reports a key that does not fit another one; returns the keys of other units that fit.
    fn refuse_unfit(
        &mut self,
        row: &'static Schema,
        name: &str,
        key: &Key,
        scope: &Scope<'_>,
    ) -> Vec<&'static str> {
        let stem = suggest::stem(name);
        let mut others = self.allowed(scope);
        others.retain(|other| stem.is_some() && suggest::stem(other) == stem);
        let (of, values) = condition(row, "x-only").unwrap_or(("type", &[]));
        let words: Vec<String> = values.iter().map(Schema::to_string).collect();
        let words = format!("{of} = {}", words.join(" or "));
        let value = scope.row(of).and_then(|(s, _)| s.table.get(of));
        let problem = match value.map(|value| self.findings.document.excerpt(value)) {
            Some(value) => format!("the key does not fit {of} = {value}"),
            None => format!("the key has no effect without {words}"),
        };
        let (code, remedy) = match others.is_empty() {
            false => (self.format.unit, format!("write {}", others.join(" or "))),
            true => (
                text_of(row, "x-only-code").unwrap_or(match self.code == self.format.range {
                    true => self.format.unfit,
                    false => self.code,
                }),
                format!("remove it, or write {words}"),
            ),
        };
        self.findings.refuse(code, key, problem, remedy);
        others
    }

    /// Reports a key without the one that it needs.
    fn check_needs(&mut self, row: &'static Schema, key: &Key, scope: &Scope<'_>) {
        let needed = text_of(row, "x-needs");
        let Some((needed, (table, row))) = needed.and_then(|n| Some((n, scope.row(n)?))) else {
            return;
        };
        let here = table.key.at(needed);
        if !table.table.contains_key(needed) && !self.findings.has_near(&here) {
            let about = text_of(row, "description").unwrap_or_default();
            let about = about.split([':', '.']).next().unwrap_or_default();
            let problem = format!("required key missing beside {}", key.path);
            let remedy = format!("add {needed}: {about}");
            self.findings
                .refuse(self.format.missing, &here, problem, remedy);
        }
    }

    fn value(
        &mut self,
        schema: &'static Schema,
        value: &Spanned<DeValue<'_>>,
        key: &Key,
        scope: &Scope<'_>,
    ) -> Option<Value> {
        let alternatives = self.alternatives(schema);
        if self.findings.is_full() {
            return None;
        }
        if value.get_ref().as_str() == Some("?") {
            let problem = "the question has no answer";
            let remedy = "write the value in place of \"?\": the comment of the line says which";
            let code = self.format.missing;
            return self.findings.refused(code, key, problem, remedy);
        }
        let (kind, words) = match value.get_ref() {
            DeValue::String(_) => ("string", "text"),
            DeValue::Integer(_) | DeValue::Float(_) => ("number", "a number"),
            DeValue::Boolean(_) => ("boolean", "true or false"),
            DeValue::Datetime(_) => ("date", "a date"),
            DeValue::Array(_) => ("array", "a list"),
            DeValue::Table(_) => ("object", "a table"),
        };
        let fitting = alternatives.iter().find(|a| type_of(a) == Some(kind));
        let Some(&inner) = fitting else {
            return self.wrong_type(&alternatives, value.get_ref(), words, key);
        };
        match value.get_ref() {
            DeValue::String(text) => self.string(inner, &alternatives, text, key),
            DeValue::Integer(integer) => {
                let number = i64::from_str_radix(integer.as_str(), integer.radix())
                    .map(|n| n as f64)
                    .or_else(|_| integer.as_str().parse());
                self.number(inner, number.unwrap_or(f64::NAN), key)
            }
            DeValue::Float(float) => {
                self.number(inner, float.as_str().parse().unwrap_or(f64::NAN), key)
            }
            DeValue::Boolean(flag) => Some(Value::Boolean(*flag)),
            DeValue::Array(items) => self.array((schema, &alternatives), items, key, scope),
            DeValue::Table(table) => {
                let table = self.table(inner, table, key, value.span().start, Some(scope));
                Some(Value::Table(table))
            }
            DeValue::Datetime(_) => None,
        }
    }

    fn array(
        &mut self,
        (row, alternatives): (&'static Schema, &[&'static Schema]),
        items: &[Spanned<DeValue<'_>>],
        key: &Key,
        scope: &Scope<'_>,
    ) -> Option<Value> {
        // Numbers or rows of numbers: the first element decides.
        let first = items.first();
        let nested = first.is_some_and(|first| first.get_ref().is_array());
        let lists = alternatives.iter().copied();
        let lists = lists.filter(|a| type_of(a) == Some("array"));
        let chosen = lists.min_by_key(|a| {
            let inner = a.get("items").map(|items| self.resolve(items));
            (inner.and_then(type_of) == Some("array")) != nested
        })?;
        let bound = |name: &str| chosen.get(name).and_then(Schema::as_u64);
        let length = items.len() as u64;
        if bound("minItems").is_some_and(|n| length < n)
            || bound("maxItems").is_some_and(|n| length > n)
        {
            let problem = format!("the list has {length} entries");
            let remedy = format!("write {}", self.expected(&[chosen]));
            return self
                .findings
                .refused(self.format.kind, key, problem, remedy);
        }
        self.check_unique(row, items, key);
        let inner = chosen.get("items")?;
        let mut clean = Vec::with_capacity(items.len());
        let mut whole = true;
        for (index, item) in items.iter().enumerate() {
            let mut here = key.index(index);
            if let Some(table) = item.get_ref().as_table() {
                let name = table.get("name").and_then(|name| name.get_ref().as_str());
                here.subject = subject(&key.path, name);
            }
            match self.value(inner, item, &here, scope) {
                Some(item) => clean.push(item),
                None => whole = false,
            }
        }
        whole.then_some(Value::Array(clean))
    }

    /// Reports entries of a list of tables that agree in the keys that tell them apart.
    fn check_unique(&mut self, row: &Schema, items: &[Spanned<DeValue<'_>>], key: &Key) {
        let keys = row.get("x-unique").and_then(Schema::as_array);
        let keys: Vec<&str> = keys
            .into_iter()
            .flatten()
            .filter_map(Schema::as_str)
            .collect();
        let mut seen: HashMap<Vec<&str>, usize> = HashMap::new();
        for (index, item) in items.iter().enumerate().filter(|_| !keys.is_empty()) {
            let text = |key: &&str| item.get_ref().get(*key)?.get_ref().as_str();
            let Some(own) = keys.iter().map(text).collect::<Option<Vec<&str>>>() else {
                continue;
            };
            let first = *seen.entry(own).or_insert(index);
            if first != index {
                let here = Key::entry(&key.path.to_string(), index, None).at("name");
                let problem = format!("{}[{first}] has the same {}", key.path, keys.join(" and "));
                self.findings
                    .refuse("E0110", &here, problem, "rename one of them");
            }
        }
    }

    /// Checks the spelling of a name, or that the name of another entry exists.
    fn check_name(&mut self, schema: &'static Schema, text: &str, key: &Key) -> bool {
        if schema.get("x-name").is_some()
            && let Some(problem) = misspelt(text)
        {
            let bare = Key {
                path: key.path.clone(),
                subject: String::new(),
            };
            let problem = problem.to_owned();
            self.findings
                .refuse("E0109", &bare, problem, "give it a plain name");
        }
        let Some(list) = text_of(schema, "x-names") else {
            return true;
        };
        let document = self.findings.document;
        let names = self.names.entry(list).or_insert_with(|| {
            let entries = document
                .table
                .get(list)
                .and_then(|l| l.get_ref().as_array());
            let names = entries.into_iter().flatten();
            let names = names.filter_map(|e| e.get_ref().get("name")?.get_ref().as_str());
            names.map(str::to_owned).collect()
        });
        let found = names.contains(text);
        if !found {
            let mut names: Vec<&str> = names.iter().map(String::as_str).collect();
            names.sort_unstable();
            unknown_name(key, list, text, &names, self.findings);
        }
        found
    }

    fn string(
        &mut self,
        schema: &'static Schema,
        alternatives: &[&'static Schema],
        text: &str,
        key: &Key,
    ) -> Option<Value> {
        if !self.check_name(schema, text, key) {
            return None;
        }
        let words = words(alternatives);
        let free = alternatives
            .iter()
            .any(|a| type_of(a) == Some("string") && words_of(a).is_empty());
        if free || words.contains(&text) {
            return Some(Value::String(text.to_owned()));
        }
        let nearest = match poinsot_files::nearest(text, &words) {
            Some(word) => format!("; did you mean \"{word}\"?"),
            None => String::new(),
        };
        let problem = "the word is not one of those allowed here";
        let remedy = format!("write {}{nearest}", self.expected(alternatives));
        self.findings.refused(self.word, key, problem, remedy)
    }

    fn number(&mut self, schema: &'static Schema, number: f64, key: &Key) -> Option<Value> {
        let whole = schema.get("type").is_some_and(|t| t == "integer");
        let (range, kind) = (self.format.range, self.format.kind);
        let fault = if !number.is_finite() {
            Some((range, "the number is not finite", "write a finite number"))
        } else if number.abs() > LARGEST {
            let remedy = "check its unit: all quantities are SI";
            Some((range, "the number is larger than 1e30", remedy))
        } else {
            let fractional = whole && number.fract() != 0.0;
            fractional.then_some((kind, "the number is not whole", "write a whole number"))
        };
        if let Some((code, problem, remedy)) = fault {
            return self.findings.refused(code, key, problem, remedy);
        }
        if let Some((problem, remedy)) = out_of_range(schema, &key.path, number) {
            self.findings.refuse(self.code, key, problem, remedy);
            if whole {
                return None;
            }
        }
        Some(match whole {
            true => Value::Integer(number as i64),
            false => Value::Float(number),
        })
    }

    fn wrong_type(
        &mut self,
        alternatives: &[&'static Schema],
        value: &DeValue<'_>,
        found: &str,
        key: &Key,
    ) -> Option<Value> {
        let sections = alternatives.iter().any(|a| {
            type_of(a) == Some("array")
                && a.get("items")
                    .is_some_and(|items| type_of(self.resolve(items)) == Some("object"))
        });
        let name = key.path.to_string();
        let remedy = if sections && value.is_table() {
            format!("write [[{name}]] with two brackets: there may be several")
        } else {
            format!("write {}", self.expected(alternatives))
        };
        let problem = format!("{found} is here, but another type is needed");
        self.findings
            .refused(self.format.kind, key, problem, remedy)
    }

    /// Expected values, as text.
    fn expected(&self, alternatives: &[&'static Schema]) -> String {
        let mut texts: Vec<String> = Vec::new();
        let words = words(alternatives);
        if !words.is_empty() {
            texts.push(quoted(&words));
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

    fn expected_list(&self, list: &'static Schema) -> String {
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
                let alternatives = inner.map_or_else(Vec::new, |inner| self.alternatives(inner));
                match words(&alternatives) {
                    words if words.is_empty() => format!("a list of {count}texts in quotes"),
                    words => format!("a list of {}", quoted(&words)),
                }
            }
        }
    }
}

/// What is wrong with a number beyond the bounds of its row, and what to do.
fn out_of_range(row: &Schema, path: &KeyPath, x: f64) -> Option<(String, String)> {
    let key = path.key_name();
    let what = suggest::stem(key).unwrap_or(key).replace('_', " ");
    let bound = |name: &str| row.get(name).and_then(Schema::as_f64);
    let above = bound("exclusiveMinimum").filter(|b| x <= *b);
    let least = bound("minimum").filter(|b| x < *b);
    let below = bound("exclusiveMaximum").filter(|b| x >= *b);
    let most = bound("maximum").filter(|b| x > *b);
    let advice = text_of(row, "x-advice");
    let (greater, smaller) = ("give a greater number", "give a smaller number");
    let (problem, usual) = match (above, least, below, most) {
        (Some(0.0), ..) => {
            let problem = format!("the {what} must be greater than zero");
            return Some((problem, "give a positive number".to_owned()));
        }
        (_, Some(0.0), ..) => ("is negative".to_owned(), "give zero or a positive number"),
        (_, Some(b), ..) if b < TINY => (format!("is below {}", as_read(b)), greater),
        (Some(b), ..) => (format!("must be greater than {}", as_read(b)), greater),
        (_, Some(b), ..) => (format!("must be at least {}", as_read(b)), greater),
        (_, _, Some(b), _) => (format!("must be below {}", as_read(b)), smaller),
        (.., Some(b)) => (format!("must be at most {}", as_read(b)), smaller),
        _ => return None,
    };
    let angle = bound("maximum").filter(|b| key.ends_with("_rad") && x.abs() > *b);
    if let Some(most) = angle {
        let (degrees, radians) = (short(x), short(x.to_radians()));
        let remedy = format!("write radians; {degrees} deg are {radians} rad");
        return Some((format!("the angle is beyond {} rad", short(most)), remedy));
    }
    let problem = format!("the {what} {problem}");
    Some((problem, advice.unwrap_or(usual).to_owned()))
}

/// The rows of a table.
fn rows(schema: &'static Schema) -> Option<&'static serde_json::Map<String, Schema>> {
    schema.get("properties").and_then(Schema::as_object)
}

/// A text of a row.
fn text_of<'s>(row: &'s Schema, name: &str) -> Option<&'s str> {
    row.get(name).and_then(Schema::as_str)
}

/// The other key that a row asks for, and its values.
fn condition(row: &'static Schema, what: &str) -> Option<(&'static str, &'static [Schema])> {
    let (name, values) = row.get(what)?.as_object()?.iter().next()?;
    Some((name.as_str(), values.as_array()?.as_slice()))
}

fn is_required(schema: &Schema, name: &str) -> bool {
    let required = schema.get("required").and_then(Schema::as_array);
    required.is_some_and(|required| required.iter().any(|n| n == name))
}

/// Whether a value says the same as a missing key.
fn is_none(value: &DeValue<'_>) -> bool {
    matches!(value, DeValue::Boolean(false)) || value.as_str() == Some("none")
}

fn type_of(schema: &Schema) -> Option<&str> {
    match schema.get("type").and_then(Schema::as_str) {
        Some("integer") => Some("number"),
        None if schema.get("const").is_some() || schema.get("enum").is_some() => Some("string"),
        other => other,
    }
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

/// Words in quotes, with commas between them.
pub(crate) fn quoted(words: &[&str]) -> String {
    let quoted: Vec<String> = words.iter().map(|w| format!("\"{w}\"")).collect();
    quoted.join(", ")
}

fn words(alternatives: &[&'static Schema]) -> Vec<&'static str> {
    alternatives.iter().flat_map(|a| words_of(a)).collect()
}
