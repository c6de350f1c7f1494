//! Matrices most of whose elements are zero.

/// Rows of a matrix by their elements that are not zero, one row behind the other.
#[derive(Default, Clone)]
pub(super) struct SparseRows {
    elements: Vec<(usize, f64)>,
    /// Where each row ends.
    ends: Vec<usize>,
}

impl SparseRows {
    pub(super) fn clear(&mut self) {
        self.elements.clear();
        self.ends.clear();
    }

    pub(super) fn len(&self) -> usize {
        self.ends.len()
    }

    pub(super) fn push(&mut self, row: impl IntoIterator<Item = (usize, f64)>) {
        self.elements.extend(row);
        self.ends.push(self.elements.len());
    }

    pub(super) fn push_dense(&mut self, row: &[f64]) {
        let pairs = row.iter().copied().enumerate();
        self.push(pairs.filter(|(_, f)| *f != 0.0));
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &[(usize, f64)]> {
        let begins = std::iter::once(0).chain(self.ends.iter().copied());
        let places = begins.zip(&self.ends);
        places.map(|(begin, end)| &self.elements[begin..*end])
    }
}
