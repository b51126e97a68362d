# SPDX-License-Identifier: MIT
"""Recipe for Spack 1: put this file into packages/slideline/ of a repository of recipes, and call Spack beside the source
archive of the release. `url` and its checksum are filled in where the release is published."""
import os

from spack.package import *
from spack_repo.builtin.build_systems.cmake import CMakePackage, generator


class Slideline(CMakePackage):
    """2D explicit and implicit contact dynamics with seven contact formulations, from LS-DYNA keyword decks."""

    manual_download = True
    url = f"file://{os.getcwd()}/slideline-0.4.0-source.tar.gz"

    license("MIT")

    version("0.4.0")

    variant("mpi", default=False, description="Share explicit runs among processes")
    variant("umfpack", default=True, description="Solve large implicit systems by UMFPACK")

    depends_on("c", type="build")
    depends_on("cxx", type="build")
    depends_on("fortran", type="build")
    depends_on("cmake@3.22:", type="build")
    depends_on("python@3.10:", type=("build", "run"))
    depends_on("hdf5+fortran~mpi")
    depends_on("lapack")
    depends_on("zlib-api")
    depends_on("suite-sparse", when="+umfpack")
    depends_on("mpi", when="+mpi")
    for tool in ("py-numpy@2.0:", "py-h5py@3.11: ~mpi", "py-matplotlib@3.9:", "py-pandas@2.2.2:", "py-jinja2@3.1:"):
        depends_on(tool, type="run")

    generator("ninja")

    def cmake_args(self):
        """Tuned by the flags of Spack's target alone."""
        return [self.define("SLIDELINE_TESTS", False), self.define("SLIDELINE_NATIVE", False),
                self.define_from_variant("SLIDELINE_MPI", "mpi"), self.define_from_variant("SLIDELINE_UMFPACK", "umfpack")]
