//! The methods, and what some lack.

use plumbline_grasp::{Corrections, Method};

use super::view::MethodView;

/// All methods, with what they lack.
pub fn methods(corrections: &Corrections) -> Vec<MethodView> {
    let view = |method| MethodView { method, about: about(method), lacks: lacks(method, corrections) };
    Method::ALL.into_iter().map(view).collect()
}

/// How a method brings the hand to the object.
fn about(method: Method) -> &'static str {
    match method {
        Method::M1 => "as described, heights from touches",
        Method::M2 => "a network of touches corrects sideways, heights from touches",
        Method::M3 => "a network of touches corrects all three",
        Method::M4 => "as described, then the detected hand is brought over the object",
        Method::M5 => "named effects, then the hand is brought over it by sight",
    }
}

/// What a method lacks and how to get it; `None`: nothing.
pub fn lacks(method: Method, corrections: &Corrections) -> Option<String> {
    let m1 = corrections.m1.is_none().then_some("M1");
    let missing: Vec<&str> = match method {
        Method::M1 | Method::M4 => m1.into_iter().collect(),
        Method::M2 => m1.into_iter().chain(corrections.m2.is_none().then_some("M2")).collect(),
        Method::M3 => corrections.m3.is_none().then_some("M3").into_iter().collect(),
        Method::M5 => vec![],
    };
    (!missing.is_empty()).then(|| {
        format!(
            "{} needs {} trained from touches: train in Models.",
            method.name().to_uppercase(),
            missing.join(" and ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_touches_only_m5_lacks_nothing() {
        let methods = methods(&Corrections::default());
        let ready: Vec<Method> =
            methods.iter().filter(|view| view.lacks.is_none()).map(|view| view.method).collect();
        assert_eq!(ready, [Method::M5]);
        let m2 = methods.iter().find(|view| view.method == Method::M2).and_then(|view| view.lacks.clone());
        assert_eq!(m2.as_deref(), Some("M2 needs M1 and M2 trained from touches: train in Models."));
    }
}
