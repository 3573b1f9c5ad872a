//! The lattice of regular triangle meshes.
//!
//! Points are named (i,j), i along the u and j along the v of a triangle with the corners (0,0), (1,0), (0,1); the third
//! direction runs from (1,0) to (0,1).

/// Directions of the six neighbours of a point, counter-clockwise.
pub const NEIGHBOURS: [[isize; 2]; 6] = [[1, 0], [0, 1], [-1, 1], [-1, 0], [0, -1], [1, -1]];

/// The corners of the triangle and their neighbours, row by row; the corners are 4, 5 and 8.
pub const NET: [[isize; 2]; 12] =
    [[0, -1], [1, -1], [2, -1], [-1, 0], [0, 0], [1, 0], [2, 0], [-1, 1], [0, 1], [1, 1], [-1, 2], [0, 2]];
