-- A pandoc filter for one page of the site: links to other guides become links to their pages, pictures lie in pictures/, and the
-- page's sections are appended to the search index.
--   PAGES: file of lines "PAGE.html<tab>GUIDE.md"; PAGE, GUIDE: this page; INDEX: the file to append to.
local page_of, guide, page = {}, os.getenv("GUIDE"), os.getenv("PAGE")
for line in io.lines(os.getenv("PAGES")) do
  local to, from = line:match("^([^\t]+)\t(.+)$")
  page_of[from] = to
end

-- The path, relative to the top folder, of what this guide links to.
local function from_top(target)
  local parts = {}
  for part in ((guide:match("^(.*/)") or "") .. target):gmatch("[^/]+") do
    if part == ".." then
      table.remove(parts)
    elseif part ~= "." then
      parts[#parts + 1] = part
    end
  end
  return table.concat(parts, "/")
end

local function is_elsewhere(target)
  return target:match("^%a[%w+.-]*:") or target:match("^#")
end

function Link(link)
  if is_elsewhere(link.target) then return nil end
  local path, anchor = link.target:match("^([^#]*)(#?.*)$")
  local top = from_top(path)
  local to = page_of[top] or page_of[top .. "/README.md"]
  if to then
    link.target = to .. anchor
    return link
  end
  return link.content -- a file of the sources, which the site has not
end

function Image(image)
  if not is_elsewhere(image.src) then image.src = "pictures/" .. image.src:match("[^/]+$") end
  return image
end

local function quoted(text)
  return '"' .. text:gsub('[%c"\\<]', function(c) return string.format("\\u%04x", c:byte()) end) .. '"'
end

function Pandoc(document)
  local title, anchor, words, name = "", "", {}, nil
  local index = io.open(os.getenv("INDEX"), "a")
  local function write()
    local text = table.concat(words, " "):gsub("%s+", " ")
    if name and (text ~= "" or title ~= "") then
      index:write("[", quoted(page .. anchor), ",", quoted(name), ",", quoted(title), ",", quoted(text), "],\n")
    end
    words = {}
  end
  for _, block in ipairs(document.blocks) do
    if block.t == "Header" then
      write()
      title, anchor = pandoc.utils.stringify(block), "#" .. block.identifier
      if not name then name, anchor = title, "" end
    else
      words[#words + 1] = pandoc.write(pandoc.Pandoc({block}), "plain", {wrap_text = "none"})
    end
  end
  write()
  index:close()
  document.meta.title = name
  return document
end
