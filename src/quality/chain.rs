//! Creases as chains of control edges.

use std::collections::BTreeMap;

/// Vertices in a row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Chain {
    /// Control vertices; the first one is not repeated where it is closed.
    pub vertices: Vec<u32>,
    /// The last vertex is joined to the first.
    pub closed: bool,
}

impl Chain {
    /// Its edges, each with the lower vertex first.
    pub fn edges(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let count = self.vertices.len();
        let edges = if self.closed { count } else { count - 1 };
        (0..edges).map(move |i| {
            let [a, b] = [self.vertices[i], self.vertices[(i + 1) % count]];
            [a.min(b), a.max(b)]
        })
    }

    /// All chains of some edges (sorted, the lower vertex first): they end where other than two of the edges meet.
    pub(super) fn of(edges: &[[u32; 2]]) -> Vec<Chain> {
        let mut at: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for &[a, b] in edges {
            at.entry(a).or_default().push(b);
            at.entry(b).or_default().push(a);
        }
        let mut free: std::collections::BTreeSet<[u32; 2]> = edges.iter().copied().collect();
        let mut walk = |start: u32, next: u32| {
            let mut vertices = vec![start];
            let (mut from, mut to) = (start, next);
            while free.remove(&[from.min(to), from.max(to)]) {
                vertices.push(to);
                let &[a, b] = &at[&to][..] else { break };
                (from, to) = (to, if a == from { b } else { a });
            }
            let closed = vertices.len() > 3 && vertices.last() == Some(&start) && at[&start].len() == 2;
            if closed {
                vertices.pop();
            }
            (vertices.len() > 1).then_some(Chain { vertices, closed })
        };
        let ends = at.iter().filter(|(_, others)| others.len() != 2);
        let mut chains: Vec<Chain> = ends
            .flat_map(|(&end, others)| others.iter().map(move |&next| (end, next)))
            .filter_map(|(a, b)| walk(a, b))
            .collect();
        // What is left are loops.
        chains.extend(edges.iter().filter_map(|&[a, b]| walk(a, b)));
        chains.sort_by(|a, b| a.vertices.cmp(&b.vertices));
        chains
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_end_at_ends_and_junctions_and_loops_close() {
        let chains = Chain::of(&[[0, 1], [1, 2], [2, 3], [2, 4], [5, 6], [5, 7], [6, 7]]);
        let found: Vec<(&[u32], bool)> = chains.iter().map(|chain| (&chain.vertices[..], chain.closed)).collect();
        let expected: [(&[u32], bool); 4] =
            [(&[0, 1, 2], false), (&[2, 3], false), (&[2, 4], false), (&[5, 6, 7], true)];
        assert_eq!(found, expected);
        assert_eq!(chains[3].edges().collect::<Vec<_>>(), [[5, 6], [6, 7], [5, 7]]);
        // A loop that hangs on a chain is two of them, and no edge is lost.
        let chains = Chain::of(&[[0, 1], [1, 2], [1, 3], [2, 3]]);
        let found: Vec<(&[u32], bool)> = chains.iter().map(|chain| (&chain.vertices[..], chain.closed)).collect();
        assert_eq!(found, [(&[0u32, 1][..], false), (&[1, 2, 3, 1], false)]);
        assert_eq!(chains.iter().flat_map(Chain::edges).count(), 4);
    }
}
