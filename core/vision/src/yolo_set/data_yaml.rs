//! The file that names the classes and says where the images are.

use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};

use plumbline_model::ClassNames;
use plumbline_model::files::{self, Size};
use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};

use super::{Split, YoloSetError};

/// A `data.yaml`, checked.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DataYaml {
    /// The file itself.
    pub file: PathBuf,
    /// Folder that the parts are relative to.
    pub root: PathBuf,
    /// The classes.
    pub names: ClassNames,
    /// As written: folders, or lists of images.
    places: BTreeMap<Split, Vec<String>>,
}

#[derive(serde::Deserialize)]
struct Raw {
    path: Option<String>,
    train: Option<Places>,
    val: Option<Places>,
    validation: Option<Places>,
    test: Option<Places>,
    nc: Option<usize>,
    names: Option<Names>,
}

impl DataYaml {
    /// Reads and checks it.
    pub fn read(file: &Path) -> Result<Self, YoloSetError> {
        let bytes = files::read(file, Size::SHORT)?;
        let bad = |reason: String| YoloSetError::DataYaml { file: file.to_owned(), reason };
        let text = String::from_utf8(bytes).map_err(|_| bad("it is no text in UTF-8".to_owned()))?;
        let text = text.trim_start_matches('\u{feff}');
        let options = serde_saphyr::options! { with_snippet: false };
        let raw: Raw =
            serde_saphyr::from_str_with_options(text, options).map_err(|error| bad(error.to_string()))?;
        let names = match raw.names {
            None => return Err(bad("it has no names".to_owned())),
            Some(names) => names.in_order().map_err(bad)?,
        };
        if let Some(nc) = raw.nc.filter(|nc| *nc != names.len()) {
            return Err(YoloSetError::ClassCount { file: file.to_owned(), nc, named: names.len(), names });
        }
        check_names(&names)?;
        let beside = file.parent().unwrap_or(Path::new("")).to_owned();
        // Without `path` everything is relative to the file; an absolute one stands for itself.
        let root = raw.path.filter(|path| !path.is_empty()).map_or(beside.clone(), |path| beside.join(path));
        let parts =
            [(Split::Train, raw.train), (Split::Val, raw.val.or(raw.validation)), (Split::Test, raw.test)];
        let places = parts.into_iter().filter_map(|(split, places)| {
            let places: Vec<String> = places?.0.into_iter().filter(|place| !place.is_empty()).collect();
            (!places.is_empty()).then_some((split, places))
        });
        Ok(Self { file: file.to_owned(), root, names, places: places.collect() })
    }

    /// Whether it has this part.
    pub fn has(&self, split: Split) -> bool {
        self.places.contains_key(&split)
    }

    /// The parts it has, for messages.
    pub fn parts(&self) -> String {
        let keys: Vec<&str> = self.places.keys().map(|split| split.key()).collect();
        if keys.is_empty() { "nothing".to_owned() } else { keys.join(" and ") }
    }

    /// Folders and lists of a part that are there.
    pub fn places(&self, split: Split) -> Result<Vec<PathBuf>, YoloSetError> {
        let Some(written) = self.places.get(&split) else {
            let (file, there) = (self.file.clone(), self.parts());
            return Err(YoloSetError::NoSuchSplit { file, split, there });
        };
        written.iter().map(|place| self.place(split, place)).collect()
    }

    fn place(&self, split: Split, written: &str) -> Result<PathBuf, YoloSetError> {
        let looked_at = self.root.join(written);
        // Sets packed for download say ../train/images for a folder that lies beside data.yaml.
        let packed = written.strip_prefix("../").map(|below| self.root.join(below));
        let place = [Some(looked_at.clone()), packed].into_iter().flatten().find(|place| place.exists());
        place.ok_or_else(|| YoloSetError::NoImages {
            file: self.file.clone(),
            key: split.key(),
            written: written.to_owned(),
            looked_at,
        })
    }
}

/// Every name once, none empty, none that cannot be written.
pub(super) fn check_names(names: &ClassNames) -> Result<(), YoloSetError> {
    for (class, name) in names.iter() {
        let repeated = names.index_of(name) != Some(class);
        if repeated || name.trim().is_empty() || name.chars().any(char::is_control) {
            return Err(YoloSetError::ClassName(name.to_owned()));
        }
    }
    Ok(())
}

/// The text of a `data.yaml` that lies in the folder of the set. It has no `path`: trainers take
/// a relative one from wherever they were started, but the parts from the file itself.
pub(super) fn text(names: &ClassNames, splits: &[Split]) -> String {
    let mut text = String::new();
    for split in splits {
        text += &format!("{0}: images/{0}\n", split.key());
    }
    text += &format!("nc: {}\nnames:\n", names.len());
    for (class, name) in names.iter() {
        text += &format!("  {}: '{}'\n", class.0, name.replace('\'', "''"));
    }
    text
}

/// One place or several.
struct Places(Vec<String>);

impl<'de> Deserialize<'de> for Places {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OneOrMore;
        impl<'de> Visitor<'de> for OneOrMore {
            type Value = Places;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a folder of images, a list of folders, or a text file that lists images")
            }
            fn visit_str<E>(self, place: &str) -> Result<Places, E> {
                Ok(Places(vec![place.to_owned()]))
            }
            fn visit_unit<E>(self) -> Result<Places, E> {
                Ok(Places(Vec::new()))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Places, A::Error> {
                let mut places = Vec::new();
                while let Some(place) = seq.next_element()? {
                    places.push(place);
                }
                Ok(Places(places))
            }
        }
        deserializer.deserialize_any(OneOrMore)
    }
}

/// Names as a list, or each with its number.
enum Names {
    List(Vec<String>),
    Numbered(BTreeMap<usize, String>),
}

impl Names {
    fn in_order(self) -> Result<ClassNames, String> {
        match self {
            Self::List(names) => Ok(ClassNames::new(names)),
            Self::Numbered(names) => {
                if let Some(missing) = (0..names.len()).find(|number| !names.contains_key(number)) {
                    return Err(format!("its names have no number {missing}"));
                }
                Ok(ClassNames::new(names.into_values()))
            }
        }
    }
}

impl<'de> Deserialize<'de> for Names {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ListOrMap;
        impl<'de> Visitor<'de> for ListOrMap {
            type Value = Names;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the names of the classes, as a list or each with its number")
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Names, A::Error> {
                let mut names = Vec::new();
                while let Some(name) = seq.next_element()? {
                    names.push(name);
                }
                Ok(Names::List(names))
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Names, A::Error> {
                let mut names = BTreeMap::new();
                while let Some((number, name)) = map.next_entry::<usize, String>()? {
                    if names.insert(number, name).is_some() {
                        return Err(serde::de::Error::custom(format!("class {number} is named twice")));
                    }
                }
                Ok(Names::Numbered(names))
            }
        }
        deserializer.deserialize_any(ListOrMap)
    }
}
