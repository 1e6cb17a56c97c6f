// One way to deal independent pieces of work out to all cores of the computer.
//
//   std::vector<Eigen::MatrixXd> squares(parts.size());
//   InParallel(parts.size(), [&](std::size_t i) { squares[i] = parts[i].transpose() * parts[i]; });
//   for (const Eigen::MatrixXd& each : squares) sum += each;
//
// Each piece writes to a place of its own, and sums are made afterwards in the order of the pieces:
// so results are the same to the last bit for any number of cores. May be called within a piece.
// Shapes: pieces are numbered from 0 to count - 1 and begun in any order.
// Failure: all pieces are done; then the exception of the first in order is thrown, so that the
// message too is the same for any number of cores.
// Source: oneTBB, which also keeps to the processors that the process is allowed (taskset).
// Validity: pieces of a tenth of a millisecond or more. A piece must not deal out work while it
// holds a mutex: the thread that waits for it takes up other pieces, which may want the mutex.
#pragma once

#include <cstddef>
#include <functional>

namespace abbe::estimation {

void InParallel(std::size_t count, const std::function<void(std::size_t piece)>& work);

}  // namespace abbe::estimation
