//! A list without repetition.

/// Each item once, in the order of its first appearance.
///
/// ```
/// assert_eq!(poinsot_files::each_once(["b", "a", "b"]), ["b", "a"]);
/// ```
pub fn each_once<T: PartialEq>(items: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut list = Vec::new();
    for item in items {
        if !list.contains(&item) {
            list.push(item);
        }
    }
    list
}
