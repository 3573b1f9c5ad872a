//! JSON, by serde_json.

use crate::hand_made::{HOSTILE, bytes, close_camera, curves, surface};
use catoptric::output::LinesFormat;
use serde_json::Value;

/// Every number comes back to the last bit.
#[test]
fn all_comes_back() {
    let surface = surface();
    let curves = curves(&surface);
    let file = bytes(&curves, &close_camera(&surface, [64, 64]), LinesFormat::Json);
    let json: Value = serde_json::from_slice(&file).expect("it is JSON");
    assert_eq!(json["made_by"], HOSTILE);
    assert_eq!(json["field"], "curve:x < y & \"z\"");
    let found = json["curves"].as_array().expect("a list");
    assert_eq!(found.len(), curves.len());
    let numbers = |list: &Value| -> Vec<f64> {
        list.as_array().expect("a list").iter().map(|x| x.as_f64().expect("a number")).collect()
    };
    for (found, curve) in found.iter().zip(&curves) {
        assert_eq!(found["value"].as_f64(), Some(curve.value));
        assert_eq!(found["light"].as_i64(), Some(i64::from(curve.light)));
        assert_eq!(found["closed"].as_bool(), Some(curve.closed));
        let points: Vec<Vec<f64>> = found["points"].as_array().expect("a list").iter().map(numbers).collect();
        assert_eq!(points, curve.points.iter().map(|point| point.to_array().to_vec()).collect::<Vec<_>>());
        let params: Vec<Vec<f64>> = found["params"].as_array().expect("a list").iter().map(numbers).collect();
        let places = curve.places.iter().map(|place| vec![f64::from(place.face), place.u, place.v]);
        assert_eq!(params, places.collect::<Vec<_>>());
        assert!(found["params"][0][0].is_u64(), "faces are whole numbers");
    }
}

#[test]
fn no_curves_are_a_file_too() {
    let surface = surface();
    let file = bytes(&[], &close_camera(&surface, [64, 64]), LinesFormat::Json);
    let json: Value = serde_json::from_slice(&file).expect("it is JSON");
    assert_eq!(json["curves"], Value::Array(Vec::new()));
}
