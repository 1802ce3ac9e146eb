//! Joints and links that a rig file speaks of.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::rig::Checker;
use crate::robot::description::Description;

impl Checker<'_> {
    /// Joints and links that the description does not have.
    pub(super) fn names(&mut self, table: &DeTable<'_>, robot: &Description) {
        for (section, key, kind) in [
            ("servo", "joint", Kind::Joint),
            ("coupled_limit", "joint", Kind::Joint),
            ("coupled_limit", "by", Kind::Joint),
            ("eyes", "link", Kind::Link),
            ("eyes", "pan", Kind::Joint),
            ("eyes", "tilt", Kind::Joint),
            ("arm", "joints", Kind::Joint),
            ("arm", "hand", Kind::Joint),
        ] {
            for part in tables(table, section) {
                self.known(part, key, section, kind, robot);
            }
        }
        for arm in tables(table, "arm") {
            tables(arm, "tip").for_each(|tip| self.known(tip, "link", "arm.tip", Kind::Link, robot));
        }
        for pose in tables(table, "pose") {
            for joints in tables(pose, "joints_rad") {
                joints
                    .keys()
                    .for_each(|key| self.is_known(key.get_ref(), &key.span(), "pose", Kind::Joint, robot));
            }
        }
    }

    /// A name, or a list of them.
    fn known(&mut self, part: &DeTable<'_>, key: &str, section: &str, kind: Kind, robot: &Description) {
        let Some((_, value)) = part.iter().find(|(name, _)| name.get_ref() == key) else { return };
        match value.get_ref() {
            DeValue::String(name) => self.is_known(name, &value.span(), section, kind, robot),
            DeValue::Array(list) => {
                for value in list.iter() {
                    if let DeValue::String(name) = value.get_ref() {
                        self.is_known(name, &value.span(), section, kind, robot);
                    }
                }
            }
            _ => {}
        }
    }

    fn is_known(&mut self, name: &str, span: &Range<usize>, section: &str, kind: Kind, robot: &Description) {
        let unknown = match kind {
            Kind::Joint => robot.find_joint(name).err(),
            Kind::Link => robot.find_link(name).err(),
        };
        if let Some(error) = unknown {
            let what = format!(
                "{section} speaks of the {} {name}, which the description does not have",
                kind.word()
            );
            self.problems.at(span.start, what, error.to_string());
        }
    }
}

/// What a name stands for.
#[derive(Clone, Copy)]
enum Kind {
    Joint,
    Link,
}

impl Kind {
    fn word(self) -> &'static str {
        match self {
            Self::Joint => "joint",
            Self::Link => "link",
        }
    }
}

/// The tables of a name, one or several.
pub(super) fn tables<'t, 'i>(table: &'t DeTable<'i>, name: &'t str) -> impl Iterator<Item = &'t DeTable<'i>> {
    let named = table.iter().find(|(key, _)| key.get_ref() == name).map(|(_, value)| value.get_ref());
    let list = match named {
        Some(DeValue::Array(list)) => list.iter().map(Spanned::get_ref).collect(),
        Some(value) => vec![value],
        None => vec![],
    };
    list.into_iter().filter_map(|value| match value {
        DeValue::Table(table) => Some(table),
        _ => None,
    })
}
