//! Which instances of a PointInstancer are left out: `inactiveIds` and `invisibleIds`.

use std::collections::HashSet;

use openusd::sdf::{ListOp, Value};

use super::text::INACTIVE_IDS;
use super::value::{Node, one_line};
use crate::mesh::MeshError;
use crate::mesh::error::{Place, Spot};

/// Ids that are left out, at the time (`UsdGeomPointInstancer::ComputeMaskAtTime`).
pub(super) fn left_out(node: &Node<'_>) -> Result<HashSet<i64>, MeshError> {
    let mut ids: HashSet<i64> = inactive(node)?.into_iter().collect();
    ids.extend(node.longs("invisibleIds")?);
    Ok(ids)
}

/// `inactiveIds`, composed of the list operations of all layers: openusd composes none that come from text.
fn inactive(node: &Node<'_>) -> Result<Vec<i64>, MeshError> {
    let unreadable = |error: &dyn std::error::Error| MeshError::UsdUnreadable {
        at: Place::with(node.source, Spot::Whole),
        reason: format!("inactiveIds: {}", one_line(error)),
    };
    let mut operations = Vec::new();
    for site in node.prim.prim_stack().map_err(|error| unreadable(&error))? {
        let Some(layer) = node.prim.stage().layer(&site.layer) else { continue };
        for field in ["inactiveIds", INACTIVE_IDS] {
            let value = layer.data().try_field(&site.path, field).map_err(|error| unreadable(&error))?;
            operations.extend(value.and_then(|value| operation(&value)));
        }
    }
    let mut ids = Vec::new();
    operations.iter().rev().for_each(|operation| apply(operation, &mut ids));
    Ok(ids)
}

/// The list operation of a field: of a crate file as it is, of text as the words that it has.
fn operation(value: &Value) -> Option<ListOp<i64>> {
    let words = |items: &[String]| -> Vec<i64> {
        let words = items.iter().flat_map(|item| item.split([',', '[', ']', ' ', '\n', '\t', '\r']));
        words.filter_map(|word| word.parse().ok().or_else(|| Some(word.parse::<f64>().ok()? as i64))).collect()
    };
    match value {
        Value::Int64ListOp(operation) => Some(operation.clone()),
        Value::Int64Vec(ids) => Some(ListOp::explicit(ids.clone())),
        Value::UnregisteredValue(text) => Some(ListOp::explicit(words(std::slice::from_ref(text)))),
        Value::UnregisteredValueListOp(operation) => Some(ListOp {
            prepended_items: words(&operation.prepended_items),
            appended_items: words(&operation.appended_items),
            added_items: words(&operation.added_items),
            deleted_items: words(&operation.deleted_items),
            ..ListOp::default()
        }),
        _ => None,
    }
}

/// What a list operation does to the list of weaker layers (`SdfListOp::ApplyOperations`; the order is nobody's here).
fn apply(operation: &ListOp<i64>, ids: &mut Vec<i64>) {
    if operation.explicit {
        ids.clone_from(&operation.explicit_items);
        return;
    }
    ids.retain(|id| !operation.deleted_items.contains(id));
    ids.extend(&operation.added_items);
    ids.extend(&operation.prepended_items);
    ids.extend(&operation.appended_items);
}
