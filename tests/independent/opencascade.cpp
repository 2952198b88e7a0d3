// Lines and surfaces by OpenCASCADE: IntCurvesFace_ShapeIntersector on a face for each surface.
// Reads and writes as exchange.hpp says.
#include "exchange.hpp"

#include <BRepBuilderAPI_MakeFace.hxx>
#include <Geom_BSplineSurface.hxx>
#include <IntCurvesFace_ShapeIntersector.hxx>
#include <Standard_Failure.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColStd_Array2OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <gp_Lin.hxx>

// How near both must be, in scene units; OpenCASCADE's own resolution is 1e-7.
static const double RESOLUTION = 1e-7;

// The different knots, and how often each occurs.
struct Knots {
    TColStd_Array1OfReal values;
    TColStd_Array1OfInteger times;

    explicit Knots(const std::vector<double> &all)
        : values(1, count(all)), times(1, count(all)) {
        int last = 0;
        for (size_t k = 0; k < all.size(); ++k) {
            if (k == 0 || all[k] != all[k - 1]) {
                values.SetValue(++last, all[k]);
                times.SetValue(last, 0);
            }
            times.SetValue(last, times.Value(last) + 1);
        }
    }

    static int count(const std::vector<double> &all) {
        int different = 0;
        for (size_t k = 0; k < all.size(); ++k) different += k == 0 || all[k] != all[k - 1];
        return different;
    }
};

static TopoDS_Face made(const Surface &surface) {
    TColgp_Array2OfPnt points(1, surface.points[0], 1, surface.points[1]);
    TColStd_Array2OfReal weights(1, surface.points[0], 1, surface.points[1]);
    for (int i = 0; i < surface.points[0]; ++i) {
        for (int j = 0; j < surface.points[1]; ++j) {
            const double *p = surface.at(i, j);
            points.SetValue(i + 1, j + 1, gp_Pnt(p[0] / p[3], p[1] / p[3], p[2] / p[3]));
            weights.SetValue(i + 1, j + 1, p[3]);
        }
    }
    const Knots u(surface.knots[0]), v(surface.knots[1]);
    Handle(Geom_BSplineSurface) spline =
        new Geom_BSplineSurface(points, weights, u.values, v.values, u.times, v.times,
                                surface.degree[0], surface.degree[1]);
    return BRepBuilderAPI_MakeFace(spline, RESOLUTION).Face();
}

int main() {
    std::vector<TopoDS_Face> faces;
    try {
        for (const Surface &surface : read_surfaces()) faces.push_back(made(surface));
    } catch (const Standard_Failure &failure) {
        std::fprintf(stderr, "a surface is refused: %s\n", failure.GetMessageString());
        return 1;
    }
    std::vector<Ray> rays = read_rays();
    for (size_t s = 0; s < faces.size(); ++s) {
        IntCurvesFace_ShapeIntersector search;
        search.Load(faces[s], RESOLUTION);
        for (size_t r = 0; r < rays.size(); ++r) {
            const double *o = rays[r].origin, *d = rays[r].direction;
            try {
                search.Perform(gp_Lin(gp_Pnt(o[0], o[1], o[2]), gp_Dir(d[0], d[1], d[2])), 0.0,
                               RealLast());
                if (!search.IsDone()) {
                    std::printf("failed %zu %zu 1\n", r, s);
                    continue;
                }
                for (int k = 1; k <= search.NbPnt(); ++k) {
                    const gp_Pnt &p = search.Pnt(k);
                    const double uv[2] = {search.UParameter(k), search.VParameter(k)};
                    const double point[3] = {p.X(), p.Y(), p.Z()};
                    print_hit(r, s, uv, point);
                }
            } catch (const Standard_Failure &) {
                std::printf("failed %zu %zu 2\n", r, s);
            }
        }
    }
    return 0;
}
