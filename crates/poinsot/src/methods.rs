//! The command `methods`: values of `identify --method` and `--variant`.

pub use poinsot_formats::ListedMethodFile as MethodText;
use poinsot_formats::{METHODS, MethodsFile};
pub use poinsot_papers::{SettingText, VariantText};

/// Methods as a file.
///
/// ```
/// use poinsot::methods::{methods, methods_file};
///
/// assert_eq!(methods_file(methods()).methods[0].name, "auto");
/// ```
pub fn methods_file(methods: Vec<MethodText>) -> MethodsFile {
    MethodsFile {
        schema: METHODS.to_owned(),
        methods,
    }
}

/// Methods of this project: name, summary, whether they take a loss function.
const OWN: [(&str, &str, bool); 3] = [
    (
        "auto",
        "linear least squares, then maximum likelihood from its estimate",
        true,
    ),
    (
        "linear",
        "momentum equations as one linear least-squares problem",
        false,
    ),
    (
        "maximum_likelihood",
        "every measurement weighted by its own noise",
        true,
    ),
];

/// Loss functions: the variants of maximum likelihood.
const LOSSES: [(&str, &str); 3] = [
    ("gaussian", "squares"),
    (
        "huber",
        "squares up to a limit, lengths beyond (Huber 1964)",
    ),
    (
        "student_t",
        "Student's t with five degrees of freedom (Lange, Little, Taylor 1989)",
    ),
];

/// Every method, those of this project first; the first is the default.
///
/// ```
/// use poinsot::methods::methods;
///
/// let paper = |name: &str| methods().into_iter().find(|m| m.name == name).unwrap().paper;
/// assert!(paper("maximum_likelihood").is_none() && paper("ma2008").is_some());
/// ```
pub fn methods() -> Vec<MethodText> {
    let loss = |(name, summary)| VariantText { name, summary };
    let own = OWN.map(|(name, summary, takes_loss)| MethodText {
        name,
        summary,
        paper: None,
        variants: LOSSES
            .into_iter()
            .filter(|_| takes_loss)
            .map(loss)
            .collect(),
        settings: &[],
    });
    let published = poinsot_papers::METHODS.map(|method| MethodText {
        name: method.name,
        summary: method.summary,
        paper: Some(method.citation),
        variants: (method.variants)(),
        settings: method.settings,
    });
    own.into_iter().chain(published).collect()
}

/// Whether a method is one of this project's.
pub(crate) fn is_own(name: &str) -> bool {
    OWN.iter().any(|own| own.0 == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use poinsot_identify::Loss;

    #[test]
    fn exact_every_loss_is_one_of_the_estimator() {
        let found: Vec<Option<Loss>> = LOSSES.iter().map(|l| Loss::from_name(l.0)).collect();
        let all = [Loss::Gaussian, Loss::Huber, Loss::StudentT];
        assert_eq!(found, all.map(Some));
    }
}
