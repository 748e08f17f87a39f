#include <geotiffio.h>
#include <tiffio.h>
#include <xtiffio.h>

#include <array>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <tiffio.hxx>

#include "core/error.h"
#include "export/ortho.h"

namespace parkade {
namespace {

constexpr int kTileSize = 256;                  // [px]
constexpr int kZipQuality = 2;                  // of 9; the usual 6 takes three times as long
constexpr double kMeanEarthRadius = 6371008.8;  // [m] (IUGG)

void WriteTags(TIFF* tiff, const Orthophoto& ortho) {
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, static_cast<std::uint32_t>(ortho.image.cols));
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, static_cast<std::uint32_t>(ortho.image.rows));
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 8);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 4);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_RGB);
  const std::array<std::uint16_t, 1> extra = {EXTRASAMPLE_UNASSALPHA};
  TIFFSetField(tiff, TIFFTAG_EXTRASAMPLES, 1, extra.data());
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
  TIFFSetField(tiff, TIFFTAG_PREDICTOR, PREDICTOR_HORIZONTAL);
  TIFFSetField(tiff, TIFFTAG_ZIPQUALITY, kZipQuality);
  TIFFSetField(tiff, TIFFTAG_TILEWIDTH, kTileSize);
  TIFFSetField(tiff, TIFFTAG_TILELENGTH, kTileSize);
  TIFFSetField(tiff, TIFFTAG_SOFTWARE, "parkade");
  const std::array<double, 3> scale = {ortho.pixel_size, ortho.pixel_size, 0};
  const std::array<double, 6> tie_point = {0, 0, 0, ortho.left, ortho.top, 0};
  TIFFSetField(tiff, TIFFTAG_GEOPIXELSCALE, 3, scale.data());
  TIFFSetField(tiff, TIFFTAG_GEOTIEPOINTS, 6, tie_point.data());
}

void WriteGeoKeys(TIFF* tiff, const SiteDatum& datum) {
  const std::unique_ptr<GTIF, decltype(&GTIFFree)> geo(GTIFNew(tiff), &GTIFFree);
  Require(geo != nullptr, ErrorCode::kInternal, "libgeotiff could not describe the orthophoto");
  GTIFKeySet(geo.get(), GTModelTypeGeoKey, TYPE_SHORT, 1, ModelTypeProjected);
  GTIFKeySet(geo.get(), GTRasterTypeGeoKey, TYPE_SHORT, 1, RasterPixelIsArea);
  GTIFKeySet(geo.get(), GTCitationGeoKey, TYPE_ASCII, 0,
             "Parkade site: tangent plane at its datum");
  GTIFKeySet(geo.get(), GeographicTypeGeoKey, TYPE_SHORT, 1, GCS_WGS_84);
  GTIFKeySet(geo.get(), GeogAngularUnitsGeoKey, TYPE_SHORT, 1, Angular_Degree);
  GTIFKeySet(geo.get(), ProjectedCSTypeGeoKey, TYPE_SHORT, 1, KvUserDefined);
  GTIFKeySet(geo.get(), ProjectionGeoKey, TYPE_SHORT, 1, KvUserDefined);
  GTIFKeySet(geo.get(), ProjCoordTransGeoKey, TYPE_SHORT, 1, CT_TransverseMercator);
  GTIFKeySet(geo.get(), ProjLinearUnitsGeoKey, TYPE_SHORT, 1, Linear_Meter);
  GTIFKeySet(geo.get(), ProjNatOriginLatGeoKey, TYPE_DOUBLE, 1, datum.latitude_deg);
  GTIFKeySet(geo.get(), ProjNatOriginLongGeoKey, TYPE_DOUBLE, 1, datum.longitude_deg);
  GTIFKeySet(geo.get(), ProjScaleAtNatOriginGeoKey, TYPE_DOUBLE, 1,
             1 + datum.altitude / kMeanEarthRadius);
  GTIFKeySet(geo.get(), ProjFalseEastingGeoKey, TYPE_DOUBLE, 1, 0.0);
  GTIFKeySet(geo.get(), ProjFalseNorthingGeoKey, TYPE_DOUBLE, 1, 0.0);
  Require(GTIFWriteKeys(geo.get()) == 1, ErrorCode::kInternal,
          "libgeotiff could not write where the orthophoto lies");
}

void WriteTiles(TIFF* tiff, const cv::Mat& image) {
  cv::Mat tile(kTileSize, kTileSize, CV_8UC4);
  for (int y = 0; y < image.rows; y += kTileSize)
    for (int x = 0; x < image.cols; x += kTileSize) {
      tile.setTo(cv::Scalar::all(0));
      const cv::Rect part(x, y, std::min(kTileSize, image.cols - x),
                          std::min(kTileSize, image.rows - y));
      cv::cvtColor(image(part), tile(cv::Rect(0, 0, part.width, part.height)), cv::COLOR_BGRA2RGBA);
      const bool is_written = TIFFWriteTile(tiff, tile.data, static_cast<std::uint32_t>(x),
                                            static_cast<std::uint32_t>(y), 0, 0) >= 0;
      Require(is_written, ErrorCode::kInternal, "libtiff could not write the orthophoto");
    }
}

}  // namespace

std::string EncodeGeoTiff(const Orthophoto& ortho, const SiteDatum& datum) {
  XTIFFInitialize();  // libtiff learns libgeotiff's tags
  std::ostringstream stream;
  {
    const std::unique_ptr<TIFF, decltype(&TIFFClose)> tiff(TIFFStreamOpen("ortho.tif", &stream),
                                                           &TIFFClose);
    Require(tiff != nullptr, ErrorCode::kInternal, "libtiff could not begin the orthophoto");
    WriteTags(tiff.get(), ortho);
    WriteGeoKeys(tiff.get(), datum);
    WriteTiles(tiff.get(), ortho.image);
  }
  return std::move(stream).str();
}

}  // namespace parkade
