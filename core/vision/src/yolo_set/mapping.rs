//! From the classes of one list to those of another, by name and by the operator's choice; never
//! by number.

use plumbline_model::{ClassIndex, ClassNames};

use super::YoloSetError;

/// What becomes of a class.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClassTarget {
    /// It is this class of the other list.
    Class(ClassIndex),
    /// Its boxes are left out.
    LeaveOut,
}

/// What becomes of every class of a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClassMapping {
    to: ClassNames,
    targets: Vec<ClassTarget>,
}

/// A class that the other list does not have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownClass {
    /// In the list that is mapped.
    pub class: ClassIndex,
    /// Its name there.
    pub name: String,
    /// A class of the other list that is written almost the same (`left hand`, `LeftHand`). It is
    /// never taken without asking.
    pub similar: Option<ClassIndex>,
}

/// What the names alone say; the rest is for the operator.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MappingProposal {
    /// The other list.
    to: ClassNames,
    /// Per class of the list that is mapped.
    known: Vec<Option<ClassIndex>>,
    /// Classes to decide on.
    pub unknown: Vec<UnknownClass>,
    /// Whether some known class has another number in the other list.
    pub renumbered: bool,
}

impl MappingProposal {
    /// Compares two lists by name.
    pub fn new(from: &ClassNames, to: &ClassNames) -> Self {
        let known: Vec<Option<ClassIndex>> = from.iter().map(|(_, name)| to.index_of(name)).collect();
        let unknown = from.iter().filter(|(class, _)| known[class.0].is_none());
        let unknown = unknown.map(|(class, name)| UnknownClass {
            class,
            name: name.to_owned(),
            similar: to.iter().find(|(_, other)| letters(other) == letters(name)).map(|(class, _)| class),
        });
        let renumbered = known.iter().enumerate().any(|(i, class)| class.is_some_and(|class| class.0 != i));
        Self { to: to.clone(), unknown: unknown.collect(), renumbered, known }
    }

    /// The mapping, with the operator's choice for each unknown class, in the order of `unknown`.
    pub fn decide(&self, choices: &[ClassTarget]) -> Result<ClassMapping, YoloSetError> {
        let exists = |choice: &ClassTarget| match choice {
            ClassTarget::Class(class) => class.0 < self.to.len(),
            ClassTarget::LeaveOut => true,
        };
        if choices.len() != self.unknown.len() || !choices.iter().all(exists) {
            let names: Vec<&str> = self.unknown.iter().map(|class| class.name.as_str()).collect();
            return Err(YoloSetError::UnknownClasses(names.join(", ")));
        }
        let mut targets: Vec<ClassTarget> =
            self.known.iter().map(|known| known.map_or(ClassTarget::LeaveOut, ClassTarget::Class)).collect();
        for (unknown, choice) in self.unknown.iter().zip(choices) {
            targets[unknown.class.0] = *choice;
        }
        Ok(ClassMapping { to: self.to.clone(), targets })
    }
}

impl ClassMapping {
    /// The mapping of lists where every name is known; an error names those that are not.
    pub fn by_name(from: &ClassNames, to: &ClassNames) -> Result<Self, YoloSetError> {
        MappingProposal::new(from, to).decide(&[])
    }

    /// The mapping by name that leaves out what the other list does not have.
    pub fn known_only(from: &ClassNames, to: &ClassNames) -> Self {
        let target = |name: &str| to.index_of(name).map_or(ClassTarget::LeaveOut, ClassTarget::Class);
        Self { to: to.clone(), targets: from.iter().map(|(_, name)| target(name)).collect() }
    }

    /// The class of the other list; `None`: left out, or not in the list that is mapped.
    pub fn target(&self, class: ClassIndex) -> Option<ClassIndex> {
        match self.targets.get(class.0)? {
            ClassTarget::Class(class) => Some(*class),
            ClassTarget::LeaveOut => None,
        }
    }

    /// The other list.
    pub fn to_names(&self) -> &ClassNames {
        &self.to
    }
}

/// A name without case, spaces and marks.
fn letters(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}
