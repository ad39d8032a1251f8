#![allow(clippy::unwrap_used, reason = "a test may stop at the first surprise")]

use proptest::prelude::*;

use super::{FEW, Members, Value};

fn written(value: &Value) -> String {
    let mut out = Vec::new();
    value.write(&mut out);
    String::from_utf8(out).unwrap()
}

#[test]
fn makes_what_is_written_to_and_reads_null_where_nothing_is() {
    let mut value = Value::Null;
    value["a"]["b"] = 5126.into();
    value["c"] = vec![1.5f32, f32::NAN, 1e-30].into();
    value["a"]["d"] = Value::from(-3i64);
    assert_eq!(written(&value), r#"{"a":{"b":5126,"d":-3},"c":[1.5,null,1e-30]}"#);
    assert!(value["x"]["y"][7].is_null());
    assert_eq!(value["a"]["b"].as_u64(), Some(5126));
    assert_eq!(value["c"][0].as_f64(), Some(1.5));
    assert_eq!(value["c"][0].as_u64(), None);
    value["c"][0] = "\u{1}\"é".into();
    assert_eq!(written(&value["c"][0]), "\"\\u0001\\\"é\"");
}

proptest! {
    /// Whatever is set, set again and taken out, few members or many: as a plain list would have it.
    #[test]
    fn members_are_found_in_their_order(steps in proptest::collection::vec((any::<bool>(), 0..3 * FEW), 0..200)) {
        let mut value = Value::Object(Members::default());
        let mut list: Vec<(String, usize)> = Vec::new();
        for (i, (set, key)) in steps.into_iter().enumerate() {
            let name = format!("k{key}");
            let known = list.iter().position(|(known, _)| *known == name);
            if set {
                value[&*name] = i.into();
                match known {
                    Some(at) => list[at].1 = i,
                    None => list.push((name, i)),
                }
            } else {
                let removed = value.as_object_mut().unwrap().remove(&name);
                prop_assert_eq!(removed, known.map(|at| Value::from(list.remove(at).1)));
            }
        }
        let members = value.as_object().unwrap();
        prop_assert_eq!(members.iter().count(), list.len());
        for ((key, value), (name, number)) in members.iter().zip(&list) {
            prop_assert_eq!((key, value.as_u64()), (&**name, Some(*number as u64)));
            prop_assert_eq!(members.get(name), Some(value));
        }
    }
}
