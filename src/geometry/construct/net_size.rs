//! The limit on the size of the nets of constructed surfaces.

use super::ConstructError;

/// The most control points of one constructed surface: 2²⁴, half a gigabyte. The numbers of points
/// of two curves multiply.
const MAX_NET: usize = 1 << 24;

/// The number of control points of a net, if it is not too large.
pub(crate) fn net_size(nu: usize, nv: usize) -> Result<usize, ConstructError> {
    check_net(nu, nv, MAX_NET)
}

/// The product of two counts, if it is no more than a limit.
pub(crate) fn check_net(nu: usize, nv: usize, limit: usize) -> Result<usize, ConstructError> {
    let size = nu.checked_mul(nv).filter(|&points| points <= limit);
    size.ok_or(ConstructError::TooLarge { nu, nv, limit })
}
