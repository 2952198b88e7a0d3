// Lines and surfaces by SISL, SINTEF's spline library: `s1856` finds all points where a line
// meets a surface. Reads and writes as exchange.hpp says.
#include "exchange.hpp"
#include "sisl.h"

// How near both must be, in scene units: far finer than SISL's usual 1e-6, and still a
// hundred times what f64 can tell of models of size 1.
static const double RESOLUTION = 1e-13;

static SISLSurf *made(const Surface &surface) {
    // SISL wants u fastest; of polynomial surfaces x y z, of rational ones w*x w*y w*z w.
    const bool rational = surface.rational();
    std::vector<double> control;
    for (int j = 0; j < surface.points[1]; ++j) {
        for (int i = 0; i < surface.points[0]; ++i) {
            const double *point = surface.at(i, j);
            for (int k = 0; k < 3; ++k) control.push_back(rational ? point[k] : point[k] / point[3]);
            if (rational) control.push_back(point[3]);
        }
    }
    std::vector<double> u = surface.knots[0], v = surface.knots[1];
    const int copied = 1;
    return newSurf(surface.points[0], surface.points[1], surface.degree[0] + 1,
                   surface.degree[1] + 1, u.data(), v.data(), control.data(), rational ? 2 : 1, 3,
                   copied);
}

int main() {
    std::vector<SISLSurf *> surfaces;
    for (const Surface &surface : read_surfaces()) surfaces.push_back(made(surface));
    std::vector<Ray> rays = read_rays();
    for (size_t r = 0; r < rays.size(); ++r) {
        for (size_t s = 0; s < surfaces.size(); ++s) {
            int points = 0, curves = 0, status = 0;
            double *parameters = nullptr;
            SISLIntcurve **runs = nullptr;
            s1856(surfaces[s], rays[r].origin, rays[r].direction, 3, 1e-15, RESOLUTION, &points,
                  &parameters, &curves, &runs, &status);
            if (status < 0) std::printf("failed %zu %zu %d\n", r, s, status);
            for (int k = 0; k < points && status >= 0; ++k) {
                int left_u = 0, left_v = 0, trouble = 0;
                double point[3], normal[3];
                s1421(surfaces[s], 0, &parameters[2 * k], &left_u, &left_v, point, normal,
                      &trouble);
                if (trouble >= 0) print_hit(r, s, &parameters[2 * k], point);
            }
            if (curves > 0) std::printf("curve %zu %zu\n", r, s);
            std::free(parameters);
            freeIntcrvlist(runs, curves);
        }
    }
    return 0;
}
