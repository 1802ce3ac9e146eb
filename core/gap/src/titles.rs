//! Joints and links inside of a sentence, as those that were tried call them.

use plumbline_model::parameter_words;

use crate::finding::Candidate;

/// The joint or link of a site: "right elbow bend"; its plain words where nobody gave it a title.
pub fn whose(site: &str, candidates: &[Candidate]) -> String {
    let of_site = candidates.iter().filter(|candidate| candidate.site == site);
    let titled = of_site.filter_map(|candidate| candidate.title.split_once(": ")).next();
    titled.map_or_else(|| parameter_words::place(site), |(whose, _)| inside(whose))
}

/// What is `said` before the value of a parameter, where one effect stands for every joint with the title of its own:
/// "right elbow bend off by" for "right elbow y off by".
pub fn by_title(parameter: &str, said: String, candidates: &[Candidate]) -> String {
    let of_site = |candidate: &&Candidate| {
        !candidate.site.is_empty() && parameter.starts_with(&format!("{}_", candidate.site))
    };
    let site =
        candidates.iter().filter(of_site).map(|candidate| &candidate.site).max_by_key(|site| site.len());
    let titled = site.and_then(|site| {
        let rest = said.strip_prefix(&parameter_words::place(site))?;
        Some(format!("{}{rest}", whose(site, candidates)))
    });
    titled.unwrap_or(said)
}

/// Names of parts begin small inside of a sentence; abbreviations stay.
pub fn inside(title: &str) -> String {
    let mut letters = title.chars();
    match (letters.next(), letters.clone().next()) {
        (Some(first), Some(second)) if second.is_lowercase() => first.to_lowercase().chain(letters).collect(),
        _ => title.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::finding::Knowledge;

    #[test]
    fn joints_of_a_set_have_their_titles() {
        let elbow = |title: &str| Candidate {
            id: "joint-zero".to_owned(),
            site: "r_elbow_y".to_owned(),
            title: title.to_owned(),
            probability: 0.0,
            score_sigmas: 0.0,
            knowledge: Knowledge::Known,
        };
        let said = |titles: &[Candidate]| {
            by_title("r_elbow_y_offset_rad", "right elbow y off by".to_owned(), titles)
        };
        assert_eq!(said(&[elbow("Right elbow bend: zero position off")]), "right elbow bend off by");
        assert_eq!(said(&[elbow("CAN joint 3: zero position off")]), "CAN joint 3 off by");
        assert_eq!(said(&[]), "right elbow y off by", "nobody gave it a title");
        assert_eq!(by_title("offset_rad", "off by".to_owned(), &[]), "off by");
    }
}
